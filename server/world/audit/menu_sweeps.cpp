#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/part.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/objects/parts.hpp"
#include "server/world/audit/boxes_only.hpp"
#include "server/world/audit/menu_table.hpp"
#include "server/world/audit/random_questions.hpp"

namespace collided::engine {
namespace {

/// Relative slack for a point on the path, which is rounded before it is tested: some thousand roundings.
constexpr double kPlaceSlack = 1e-12;

/// A ball that moves straight from one point to another: it sweeps a capsule, which rationals can decide.
struct BallSweep {
  Vec3 from;
  Vec3 to;
  double radius_m = 0;

  Capsule until(double t, double wider_m) const {
    return {from, t == 1 ? to : Vec3(from + t * (to - from)), radius_m + wider_m};
  }
  double length_m() const { return (to - from).norm(); }
  std::vector<double> numbers() const {
    return {from.x(), from.y(), from.z(), 1, 0, 0, 0, to.x(), to.y(), to.z(), 1, 0, 0, 0};
  }
};

/// A part near the path, also as given.
struct NearPart {
  ConvexPart part;
  GivenPart given;
};

/// The contacts on the path, by rationals over every part as given.
class ExactSweep {
 public:
  ExactSweep(const Snapshot& snapshot, const BallSweep& ball) : ball_(ball) {
    slack_m_ = kPlaceSlack * (ball.from.norm() + ball.to.norm() + ball.radius_m);
    const Aabb reach = bounds(ball.until(1, slack_m_));
    visit_parts(snapshot, [&](ObjectId, std::uint32_t, const auto& shape, GivenPart given) {
      given.frame = nullptr;  // the frame ends with the visit
      if (overlaps(reach, bounds(shape))) near_.push_back({shape, given});
    });
    whole_ = touching(ball.until(1, 0));
  }

  Decision whole() const { return whole_; }
  /// True if the bracket is wrong: contact before its beginning, or none by its end.
  bool contradicts(const TimeBracket& bracket) const {
    const bool is_met_before =
        ball_.radius_m > slack_m_ && bracket.low > 0 && touching(ball_.until(bracket.low, -slack_m_)) == Decision::yes;
    return is_met_before || touching(ball_.until(bracket.high, slack_m_)) == Decision::no;
  }
  /// How far the bracket's end is from the first contact.
  double error_m(const TimeBracket& bracket) const {
    constexpr int kHalvings = 10;
    double low = bracket.low;
    double high = bracket.high;
    for (int i = 0; i < kHalvings && low < high; ++i) {
      const double middle = low / 2 + high / 2;
      (touching(ball_.until(middle, 0)) == Decision::no ? low : high) = middle;
    }
    return (bracket.high - low) * ball_.length_m();
  }

 private:
  Decision touching(const Capsule& swept) const {
    const Aabb reach = grown(bounds(swept), slack_m_);
    Decision found = Decision::no;
    for (const auto& [part, given] : near_) {
      if (!overlaps(reach, bounds_of_part(part))) continue;
      const GivenPair pair{GivenPart{}, given};
      Decision here = pair.is_exact() ? Decision::undecided : overlaps_as_given(Primitive(swept), part, pair);
      if (here == Decision::undecided)
        here = std::visit([&](const auto& shape) { return exactly::overlaps(Primitive(swept), shape); }, part);
      if (here == Decision::yes) return here;
      if (here == Decision::undecided) found = here;
    }
    return found;
  }

  BallSweep ball_;
  double slack_m_ = 0;
  std::vector<NearPart> near_;
  Decision whole_ = Decision::undecided;
};

/// Sweep questions: a ball's motions, answered by each method.
class SweepQuestions {
 public:
  SweepQuestions(const Snapshot& snapshot, std::int64_t judging_ns)
      : snapshot_(snapshot),
        table_("sweep", {{.name = "exact on doubt"},
                         {.name = "double, bounded", .highest = Level::filter},
                         {.name = "boxes only", .boxes = true}}),
        judging_(judging_ns) {}

  void ask(const BallSweep& ball) {
    Shape shape;
    shape.primitives.push_back(Sphere{Vec3::Zero(), ball.radius_m});
    const ObjectInfo mover = without_world(shape);
    const std::vector<double> numbers = ball.numbers();
    Questions question{.kind = QuestionKind::sweep, .numbers = numbers, .mover = &mover};
    answer(snapshot_, question, warm_, scratch_);
    for (std::size_t m = 0; m < kMethods; ++m) {
      question.highest = table_.methods()[m].highest;
      if (table_.methods()[m].boxes) table_.timed(m, [&] { is_box_met_ = meets_boxes(ball); });
      else table_.timed(m, [&] { answer(snapshot_, question, given_[m], scratch_); });
    }
    if (judging_.is_left()) judging_.spend([&] { judge(ball); });
    for (std::size_t m = 0; m < kMethods; ++m) {
      if (!table_.methods()[m].boxes && given_[m].answers[0] == Verdict::undecided) ++table_.row(m).undecided;
    }
  }
  void finish(std::vector<MenuRow>& menu) { table_.finish(menu); }

 private:
  static constexpr std::size_t kMethods = 3;

  /// Tests by the box around the whole path.
  bool meets_boxes(const BallSweep& ball) const {
    const Aabb box = bounds(ball.until(1, 0));
    const Vec3 middle = box.low / 2 + box.high / 2;
    const Vec3 half = (box.high - box.low) / 2;
    const std::vector<double> numbers{middle.x(), middle.y(), middle.z(), half.x(), half.y(), half.z(), 1, 0, 0, 0};
    return !answer_by_boxes(snapshot_, {.kind = QuestionKind::box, .numbers = numbers}).objects.empty();
  }

  void judge(const BallSweep& ball) {
    const ExactSweep exact(snapshot_, ball);
    for (std::size_t m = 0; m < kMethods; ++m) {
      MenuRow& row = table_.row(m);
      ++row.judged;
      if (table_.methods()[m].boxes) row.worst_bound_m = std::numeric_limits<double>::infinity();
      const bool is_claim = table_.methods()[m].boxes || given_[m].answers[0] != Verdict::undecided;
      if (!is_claim || exact.whole() == Decision::undecided) continue;
      const bool is_met = table_.methods()[m].boxes ? is_box_met_ : given_[m].answers[0] == Verdict::hit;
      if (is_met != (exact.whole() == Decision::yes)) {
        ++row.wrong;
      } else if (is_met && !table_.methods()[m].boxes) {
        judge_time(exact, given_[m].brackets[0], ball.length_m(), row);
      }
    }
  }

  static void judge_time(const ExactSweep& exact, const TimeBracket& bracket, double length_m, MenuRow& row) {
    if (exact.contradicts(bracket)) {
      ++row.wrong;
      return;
    }
    row.worst_bound_m = std::max(row.worst_bound_m, (bracket.high - bracket.low) * length_m);
    row.worst_error_m = std::max(row.worst_error_m, exact.error_m(bracket));
  }

  const Snapshot& snapshot_;
  MenuTable table_;
  JudgingTime judging_;
  Answers warm_;
  std::array<Answers, kMethods> given_;
  bool is_box_met_ = false;
  QueryScratch scratch_;
};

}  // namespace

void add_sweep_rows(const Snapshot& snapshot, const MenuOptions& options, std::vector<MenuRow>& menu) {
  RandomQuestions random(snapshot, options.seed);
  SweepQuestions questions(snapshot, options.judging_ns);
  for (std::uint32_t i = 0; i < options.questions && !(options.cancelled && options.cancelled()); ++i) {
    const std::vector<double> start = random.question(QuestionKind::sphere);
    const std::vector<double> end = random.question(QuestionKind::near);
    questions.ask({.from = {start[0], start[1], start[2]}, .to = {end[0], end[1], end[2]}, .radius_m = start[3]});
  }
  questions.finish(menu);
}

}  // namespace collided::engine
