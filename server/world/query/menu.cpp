#include "server/world/query/menu.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>

#include "server/exact_phase/exactly.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/world/objects/parts.hpp"
#include "server/world/query/boxes_only.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/random_questions.hpp"

namespace collided::engine {
namespace {

struct Method {
  std::string name;
  Level highest = Level::rational;
  double error_m = 0;
  bool boxes = false;
};

std::string length_text(double length_m) {
  if (length_m < 1e-3) return fmt::format("{:g}um", length_m * 1e6);
  return length_m < 1 ? fmt::format("{:g}mm", length_m * 1e3) : fmt::format("{:g}m", length_m);
}

/// The errors offered are powers of ten, about a millionth and a thousandth of the world's size.
std::vector<Method> methods_for(double size_m) {
  std::vector<Method> methods{{.name = "exact on doubt"}, {.name = "double, bounded", .highest = Level::filter}};
  const double magnitude = size_m > 0 ? std::floor(std::log10(size_m)) : 0;
  for (const double power : {-6.0, -3.0}) {
    const double error_m = std::pow(10.0, magnitude + power);
    methods.push_back({.name = "within " + length_text(error_m), .error_m = error_m});
  }
  methods.push_back({.name = "boxes only", .boxes = true});
  return methods;
}

std::set<ObjectId> objects_of(const std::vector<AnswerHit>& hits) {
  std::set<ObjectId> objects;
  for (const AnswerHit& hit : hits) objects.insert(hit.object);
  return objects;
}

/// The distance that is the truth, by rationals over the part that the sharp answer names; for overlaps the sharpest
/// depth there is.
class Truth {
 public:
  Truth(const Snapshot& snapshot, const Questions& question, const Answers& sharp) : sharp_(sharp) {
    if (sharp.hits.empty()) return;
    distance_m_ = sharp.hits[0].distance_m;
    const double* n = question.numbers.data();
    const AnswerHit& hit = sharp.hits[0];
    visit_part(snapshot, hit.object, hit.triangle, [&](const auto& shape) {
      if (question.kind == QuestionKind::ray) {
        RayHit exact;
        if (exactly::cast_ray(ray_of(n), shape, exact) == Decision::yes) take(exact.distance_m);
      } else if (question.kind == QuestionKind::near) {
        take(exactly::closest(point_of(n), shape).distance_m);
      }
    });
  }
  bool hit() const { return !sharp_.hits.empty(); }
  const Answers& sharp() const { return sharp_; }
  double distance_m() const { return distance_m_; }

 private:
  /// An object of several primitives names none of them: the one at the sharp distance.
  void take(double exact_m) {
    if (!taken_ || std::abs(exact_m - sharp_.hits[0].distance_m) < std::abs(distance_m_ - sharp_.hits[0].distance_m)) {
      distance_m_ = exact_m;
    }
    taken_ = true;
  }

  const Answers& sharp_;
  double distance_m_ = 0;
  bool taken_ = false;
};

void judge(const Answers& given, const Truth& truth, MenuRow& row) {
  if (given.answers[0] == Verdict::undecided) {
    ++row.undecided;
    return;
  }
  // Where less was asked for, another object than the first may be named, at a distance that is within the word.
  const bool by_object = row.kind == QuestionKind::sphere || row.kind == QuestionKind::box;
  if (by_object ? objects_of(given.hits) != objects_of(truth.sharp().hits) : given.hits.empty() == truth.hit()) {
    ++row.wrong;
    return;
  }
  for (const AnswerHit& hit : given.hits) row.worst_bound_m = std::max(row.worst_bound_m, hit.error_m);
  for (std::size_t i = 0; by_object && i < given.hits.size(); ++i) {
    const auto same = std::find_if(truth.sharp().hits.begin(), truth.sharp().hits.end(),
                                   [&](const AnswerHit& h) { return h.object == given.hits[i].object; });
    row.worst_error_m = std::max(row.worst_error_m, std::abs(given.hits[i].distance_m - same->distance_m));
  }
  if (!by_object && truth.hit()) {
    row.worst_error_m = std::max(row.worst_error_m, std::abs(given.hits[0].distance_m - truth.distance_m()));
  }
}

void judge(const BoxesAnswer& given, const Truth& truth, MenuRow& row) {
  row.worst_bound_m = std::numeric_limits<double>::infinity();
  if (row.kind == QuestionKind::sphere || row.kind == QuestionKind::box) {
    if (given.objects != objects_of(truth.sharp().hits)) ++row.wrong;
    return;
  }
  if (given.distance_m.has_value() != truth.hit()) {
    ++row.wrong;
  } else if (truth.hit()) {
    row.worst_error_m = std::max(row.worst_error_m, std::abs(*given.distance_m - truth.distance_m()));
  }
}

/// The rows of one kind of question.
class MethodRows {
 public:
  MethodRows(const Snapshot& snapshot, QuestionKind kind, const std::vector<Method>& methods)
      : snapshot_(snapshot), kind_(kind), methods_(methods), times_ns_(methods.size()) {
    for (const Method& method : methods) rows_.push_back({.kind = kind, .method = method.name});
  }
  void ask(const std::vector<double>& numbers);
  void finish(std::vector<MenuRow>& menu);

 private:
  template <class Work>
  void timed(std::size_t method, const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    times_ns_[method].push_back((std::chrono::steady_clock::now() - start).count());
  }

  const Snapshot& snapshot_;
  QuestionKind kind_;
  const std::vector<Method>& methods_;
  std::vector<std::vector<std::int64_t>> times_ns_;
  std::vector<MenuRow> rows_;
  Answers sharp_;
  Answers given_;
  QueryScratch scratch_;
};

void MethodRows::ask(const std::vector<double>& numbers) {
  Questions question{.kind = kind_, .max_hits = kind_ == QuestionKind::near ? 1U : 1'000'000U, .numbers = numbers};
  // Once untimed: it warms the caches for all methods alike, and is what the others are compared with.
  answer(snapshot_, question, sharp_, scratch_);
  // Where the covered space ends is nothing that was met.
  std::erase_if(sharp_.hits, [](const AnswerHit& hit) { return (hit.flags & kUncovered) != 0; });
  const Truth truth(snapshot_, question, sharp_);
  for (std::size_t m = 0; m < methods_.size(); ++m) {
    ++rows_[m].asked;
    if (methods_[m].boxes) {
      BoxesAnswer boxes;
      timed(m, [&] { boxes = answer_by_boxes(snapshot_, question); });
      judge(boxes, truth, rows_[m]);
    } else {
      question.highest = methods_[m].highest;
      question.error_m = methods_[m].error_m;
      timed(m, [&] { answer(snapshot_, question, given_, scratch_); });
      judge(given_, truth, rows_[m]);
    }
  }
}

void MethodRows::finish(std::vector<MenuRow>& menu) {
  for (std::size_t m = 0; m < rows_.size(); ++m) {
    std::vector<std::int64_t>& times = times_ns_[m];
    if (times.empty()) continue;
    std::sort(times.begin(), times.end());
    rows_[m].p50_ns = times[times.size() / 2];
    rows_[m].p99_ns = times[times.size() * 99 / 100];
    menu.push_back(rows_[m]);
  }
}

}  // namespace

std::vector<MenuRow> menu_of(const Snapshot& snapshot, const MenuOptions& options) {
  const OwnFloatEnvironment own_floats;
  RandomQuestions random(snapshot, options.seed);
  if (!random.has_world()) return {};
  const std::vector<Method> methods = methods_for(random.size_m());
  std::vector<MenuRow> menu;
  for (const QuestionKind kind : kPlainQuestions) {
    MethodRows rows(snapshot, kind, methods);
    for (std::uint32_t i = 0; i < options.questions && !(options.cancelled && options.cancelled()); ++i) {
      rows.ask(random.question(kind));
    }
    rows.finish(menu);
  }
  return menu;
}

}  // namespace collided::engine
