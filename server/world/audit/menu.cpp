#include "server/world/audit/menu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "server/geometry/float_environment.hpp"
#include "server/world/audit/boxes_only.hpp"
#include "server/world/audit/exact_answer.hpp"
#include "server/world/audit/menu_table.hpp"
#include "server/world/audit/random_questions.hpp"

namespace collided::engine {
namespace {

std::string length_text(double length_m) {
  if (length_m < 1e-3) return fmt::format("{:g}um", length_m * 1e6);
  return length_m < 1 ? fmt::format("{:g}mm", length_m * 1e3) : fmt::format("{:g}m", length_m);
}

/// The errors offered are powers of ten, about a millionth and a thousandth of the world's size.
std::vector<MenuMethod> methods_for(double size_m) {
  std::vector<MenuMethod> methods{{.name = "exact on doubt"}, {.name = "double, bounded", .highest = Level::filter}};
  const double magnitude = size_m > 0 ? std::floor(std::log10(size_m)) : 0;
  for (const double power : {-6.0, -3.0}) {
    const double error_m = std::pow(10.0, magnitude + power);
    methods.push_back({.name = "within " + length_text(error_m), .error_m = error_m});
  }
  methods.push_back({.name = "boxes only", .boxes = true});
  return methods;
}

bool is_overlap(QuestionKind kind) { return kind == QuestionKind::sphere || kind == QuestionKind::box; }

/// The result of one method for one question.
struct Given {
  Answers answers;
  BoxesAnswer boxes;
};

/// One kind of question: each answered by every method, then judged.
class WorldQuestions {
 public:
  WorldQuestions(const Snapshot& snapshot, QuestionKind kind, const std::vector<MenuMethod>& methods,
                 std::int64_t judging_ns)
      : snapshot_(snapshot),
        kind_(kind),
        table_(name_of(kind), methods),
        judging_(judging_ns),
        given_(methods.size()) {}

  void ask(const std::vector<double>& numbers) {
    Questions question{.kind = kind_, .max_hits = kind_ == QuestionKind::near ? 1U : 1'000'000U, .numbers = numbers};
    // Untimed first: warms the caches equally for all methods.
    answer(snapshot_, question, sharp_, scratch_);
    for (std::size_t m = 0; m < given_.size(); ++m) answer_by(m, question);
    if (judging_.is_left()) judging_.spend([&] { judge(question); });
  }
  void finish(std::vector<MenuRow>& menu) { table_.finish(menu); }

 private:
  void answer_by(std::size_t m, Questions question);
  void judge(const Questions& question);
  void judge_answer(const ExactAnswer& exact, const Answers& given, MenuRow& row) const;
  void judge_boxes(const ExactAnswer& exact, const BoxesAnswer& given, MenuRow& row) const;

  const Snapshot& snapshot_;
  QuestionKind kind_;
  MenuTable table_;
  JudgingTime judging_;
  Answers sharp_;
  std::vector<Given> given_;
  QueryScratch scratch_;
};

void WorldQuestions::answer_by(std::size_t m, Questions question) {
  const MenuMethod& method = table_.methods()[m];
  if (method.boxes) {
    table_.timed(m, [&] { given_[m].boxes = answer_by_boxes(snapshot_, question); });
    return;
  }
  question.highest = method.highest;
  question.error_m = method.error_m;
  Answers& given = given_[m].answers;
  table_.timed(m, [&] { answer(snapshot_, question, given, scratch_); });
  if (given.answers[0] == Verdict::undecided) ++table_.row(m).undecided;
  for (const AnswerHit& hit : given.hits)
    table_.row(m).worst_bound_m = std::max(table_.row(m).worst_bound_m, hit.error_m);
}

void WorldQuestions::judge(const Questions& question) {
  // An object within the allowed error may be named instead of the nearest, so all objects up to there must be known.
  double far_m = 0;
  bool is_far_known = true;
  for (std::size_t m = 0; m < given_.size(); ++m) {
    const Answers& given = given_[m].answers;
    if (table_.methods()[m].boxes || given.answers[0] == Verdict::undecided) continue;
    is_far_known = is_far_known && !given.hits.empty();
    for (const AnswerHit& hit : given.hits) far_m = std::max(far_m, hit.distance_m + hit.error_m);
  }
  const ExactAnswer exact(snapshot_, question,
                          is_far_known && far_m > 0 ? far_m : std::numeric_limits<double>::infinity());
  for (std::size_t m = 0; m < given_.size(); ++m) {
    MenuRow& row = table_.row(m);
    ++row.judged;
    if (table_.methods()[m].boxes) judge_boxes(exact, given_[m].boxes, row);
    else judge_answer(exact, given_[m].answers, row);
  }
}

void WorldQuestions::judge_answer(const ExactAnswer& exact, const Answers& given, MenuRow& row) const {
  if (given.answers[0] == Verdict::undecided) return;  // an undecided answer claims nothing
  if (!exact.difference(given).empty()) {
    ++row.wrong;
    return;
  }
  if (!is_overlap(kind_)) {
    const std::optional<Interval> first = exact.first();
    if (first)
      row.worst_error_m =
          std::max(row.worst_error_m, std::abs(given.hits[0].distance_m - (first->low / 2 + first->high / 2)));
    return;
  }
  // Depths have no second form: they are compared with those without allowed error.
  for (const AnswerHit& hit : given.hits) {
    const auto same = std::find_if(sharp_.hits.begin(), sharp_.hits.end(),
                                   [&](const AnswerHit& h) { return h.object == hit.object; });
    if (same != sharp_.hits.end())
      row.worst_error_m = std::max(row.worst_error_m, std::abs(hit.distance_m - same->distance_m));
  }
}

void WorldQuestions::judge_boxes(const ExactAnswer& exact, const BoxesAnswer& given, MenuRow& row) const {
  row.worst_bound_m = std::numeric_limits<double>::infinity();
  if (is_overlap(kind_)) {
    if (!exact.are_touched(given.objects)) ++row.wrong;
    return;
  }
  const std::optional<Interval> first = exact.first();
  if (given.distance_m.has_value() != first.has_value()) {
    ++row.wrong;
  } else if (first) {
    row.worst_error_m = std::max(row.worst_error_m, std::abs(*given.distance_m - (first->low / 2 + first->high / 2)));
  }
}

void add_own_rows(const Snapshot& snapshot, const MenuOptions& options, const std::vector<MenuMethod>& methods,
                  std::vector<MenuRow>& menu) {
  WorldQuestions questions(snapshot, options.own_kind, methods, options.judging_ns);
  const std::size_t stride = numbers_of(options.own_kind);
  for (std::size_t i = 0; i < options.own_numbers.size() && !(options.cancelled && options.cancelled()); i += stride) {
    const auto first = options.own_numbers.begin() + static_cast<std::ptrdiff_t>(i);
    questions.ask({first, first + static_cast<std::ptrdiff_t>(stride)});
  }
  questions.finish(menu);
}

}  // namespace

void MenuTable::finish(std::vector<MenuRow>& menu) {
  for (std::size_t m = 0; m < rows_.size(); ++m) {
    std::vector<std::int64_t>& times = times_ns_[m];
    if (times.empty()) continue;
    std::sort(times.begin(), times.end());
    rows_[m].p50_ns = times[times.size() / 2];
    rows_[m].p99_ns = times[times.size() * 99 / 100];
    menu.push_back(rows_[m]);
  }
}

std::vector<MenuRow> menu_of(const Snapshot& snapshot, const MenuOptions& options) {
  const OwnFloatEnvironment own_floats;
  RandomQuestions random(snapshot, options.seed);
  if (!random.has_world()) return {};
  const std::vector<MenuMethod> methods = methods_for(random.size_m());
  std::vector<MenuRow> menu;
  if (!options.own_numbers.empty()) {
    add_own_rows(snapshot, options, methods, menu);
    return menu;
  }
  for (const QuestionKind kind : kPlainQuestions) {
    WorldQuestions questions(snapshot, kind, methods, options.judging_ns);
    for (std::uint32_t i = 0; i < options.questions && !(options.cancelled && options.cancelled()); ++i) {
      questions.ask(random.question(kind));
    }
    questions.finish(menu);
  }
  add_sweep_rows(snapshot, options, menu);
  add_pair_rows(snapshot, options, menu);
  return menu;
}

}  // namespace collided::engine
