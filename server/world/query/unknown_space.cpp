#include "server/world/query/unknown_space.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <variant>

#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/parts.hpp"
#include "server/world/query/question_shapes.hpp"

namespace collided::engine {
namespace {

/// Nothing is nearer than this, even at the full error of the hit.
double least_distance(const AnswerHit& hit) { return std::max(0.0, hit.distance_m - hit.error_m); }

/// One question put to the unknown objects alone. The question itself is answered, so it can no longer be given up for
/// other requests: ending early would leave it undecided.
class UnknownQuestion {
 public:
  UnknownQuestion(Question& of, UnknownSpace& unknown) : of_(of), unknown_(unknown), asked_(of.asked) {}

  std::optional<Leaving> ray(const double* n) {
    if (of_.asked.mode == HitMode::any && !of_.found.empty()) return std::nullopt;
    std::array<double, kRayNumbers> clipped;
    std::copy_n(n, kRayNumbers, clipped.begin());
    if (of_.asked.mode != HitMode::all && !of_.found.empty())
      clipped[6] = std::min(clipped[6], least_distance(of_.found.front()));
    if (clipped[6] == 0 && !of_.found.empty()) return std::nullopt;
    asked_.mode = HitMode::closest;
    const Question met = ask(ask_ray, clipped.data());
    if (met.found.empty()) return left_open(met, point_of(n));
    return Leaving{.point = met.found.front().point, .covered_m = least_distance(met.found.front())};
  }

  /// For spheres, boxes and points: any hit means yes.
  template <class Ask>
  std::optional<Leaving> region(const Ask& ask_kind, const double* n) {
    if (!of_.found.empty()) return std::nullopt;
    asked_.mode = HitMode::any;
    const Question met = ask(ask_kind, n);
    if (met.found.empty()) return left_open(met, point_of(n));
    return Leaving{.point = nearest_to(point_of(n)), .covered_m = 0};
  }

  std::optional<Leaving> near(const double* n) {
    const bool is_full = !of_.found.empty() && of_.found.size() >= of_.asked.max_hits;
    const double reach_m = is_full ? std::min(n[3], least_distance(of_.found.back())) : n[3];
    if (is_full && reach_m == 0) return std::nullopt;
    const std::array<double, kNearNumbers> clipped{n[0], n[1], n[2], reach_m};
    asked_.mode = HitMode::closest;
    asked_.max_hits = 1;
    const Question met = ask(ask_near, clipped.data());
    if (met.found.empty()) return left_open(met, point_of(n));
    return Leaving{.point = met.found.front().point, .covered_m = 0};
  }

  std::optional<Leaving> sweep(const double* n) {
    const Question met = ask(ask_sweep, n);
    if (!met.bracket) return left_open(met, point_of(n));
    if (of_.bracket && met.bracket->low >= of_.bracket->low) return std::nullopt;
    const Vec3 from = point_of(n);
    return Leaving{.point = from + met.bracket->low * (point_of(n + kPoseNumbers) - from), .covered_m = 0};
  }

 private:
  template <class Ask>
  Question ask(const Ask& ask_kind, const double* n) {
    Question question{.snapshot = of_.snapshot,
                      .asked = asked_,
                      .allowed = unknown_.objects.by_slot(),
                      .open_scenes = unknown_.scenes,
                      .found = unknown_.found,
                      .deadline = Deadline(asked_.deadline_ns, asked_.called_off)};
    ask_kind(question, n);
    of_.walk.nodes += question.walk.nodes;
    of_.exact_tests += question.exact_tests;
    return question;
  }

  /// Without a hit it is apart, unless a test was undecided or time was over.
  static std::optional<Leaving> left_open(const Question& met, const Vec3& from) {
    if (!met.undecided && !met.deadline.was_over()) return std::nullopt;
    return Leaving{.point = from, .covered_m = 0};
  }

  Vec3 nearest_to(const Vec3& from) {
    const std::array<double, kNearNumbers> all{from.x(), from.y(), from.z(), std::numeric_limits<double>::infinity()};
    asked_.mode = HitMode::closest;
    asked_.max_hits = 1;
    const Question met = ask(ask_near, all.data());
    return met.found.empty() ? from : met.found.front().point;
  }

  Question& of_;
  UnknownSpace& unknown_;
  Questions asked_;
};

/// A box around the bounds, slightly larger to cover rounding.
Box box_about(const Aabb& bounds) {
  const Vec3 middle = bounds.low / 2 + bounds.high / 2;
  const Vec3 half = (bounds.high - middle).cwiseMax(middle - bounds.low);
  return {.center = middle, .half_m = half + kFewSlack * (half + middle.cwiseAbs())};
}

bool meets(const ObjectInfo& info, const Frame& frame, const Box& box) {
  return std::any_of(info.primitives.begin(), info.primitives.end(), [&](const Primitive& primitive) {
    const auto is_apart = [&](const auto& own) { return overlaps(box, place(frame, own)).decision == Decision::no; };
    return !std::visit(is_apart, primitive);
  });
}

}  // namespace

std::optional<Leaving> reaches_unknown(Question& question, const double* numbers, UnknownSpace& unknown) {
  UnknownQuestion ask(question, unknown);
  switch (question.asked.kind) {
    case QuestionKind::ray: return ask.ray(numbers);
    case QuestionKind::sphere: return ask.region(ask_sphere, numbers);
    case QuestionKind::box: return ask.region(ask_box, numbers);
    case QuestionKind::inside: return ask.region(ask_inside, numbers);
    case QuestionKind::near: return ask.near(numbers);
    case QuestionKind::sweep: return ask.sweep(numbers);
    default: return std::nullopt;
  }
}

std::optional<Vec3> unknown_near(const Snapshot& snapshot, std::span<const Aabb> boxes, double distance_m) {
  if (!snapshot.grid) return std::nullopt;
  WalkCost cost;
  for (const Aabb& bounds : boxes) {
    if (bounds.empty()) continue;
    const Aabb reach = grown(bounds, distance_m);
    bool is_met = false;
    const auto candidate = [&](std::uint32_t slot) {
      const ObjectInfo& info = *snapshot.objects[slot];
      is_met = info.is_unknown && meets(info, snapshot.frame(slot), box_about(reach));
      return !is_met;
    };
    snapshot.grid->walk_box(reach, candidate, cost);
    if (is_met) return Vec3(bounds.low / 2 + bounds.high / 2);
  }
  return std::nullopt;
}

}  // namespace collided::engine
