#include "server/world/query/covered.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/geometry/box_union.hpp"
#include "server/geometry/lost_in_sum.hpp"
#include "server/geometry/stable_length.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/sweep.hpp"
#include "server/world/query/question_shapes.hpp"

namespace collided::engine {
namespace {

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kSlack = 0x1p-40;     // relative; a thousand times the rounding of the value
constexpr double kRaySlack = 0x1p-49;  // twice the rounding of a length along an axis: one of 6 units, two of one

/// True if the exact sum a + b is at most the limit. False for NaN.
bool sum_is_at_most(double a, double b, double limit) {
  if (limit == kEndless) return !std::isnan(a + b);
  const double sum = a + b;
  if (!std::isfinite(sum)) return sum < limit;
  return sum < limit || (sum == limit && lost_in_sum(a, b, sum) <= 0);
}

/// a + b, rounded up to the next double if the exact sum is not a double.
double sum_rounded_up(double a, double b) {
  const double sum = a + b;
  return sum_is_at_most(a, b, sum) ? sum : std::nextafter(sum, kEndless);
}

/// True if the range from middle - down to middle + up lies within the limits, exactly.
bool is_within(double middle, double down, double up, double low, double high) {
  return sum_is_at_most(-middle, down, -low) && sum_is_at_most(middle, up, high);
}

/// Bounds how far a question reaches from its beginning along each axis.
struct QuestionExtent {
  Vec3 from = Vec3::Zero();
  Vec3 down = Vec3::Zero();
  Vec3 up = Vec3::Zero();

  bool is_within(const Aabb& box) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!engine::is_within(from[axis], down[axis], up[axis], box.low[axis], box.high[axis])) return false;
    }
    return true;
  }
  bool is_in_one_of(std::span<const Aabb> covers) const {
    return std::any_of(covers.begin(), covers.end(), [&](const Aabb& box) { return is_within(box); });
  }
  /// Rounded outward, but only if a sum is not a double.
  Aabb around() const {
    Aabb box;
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = -sum_rounded_up(-from[axis], down[axis]);
      box.high[axis] = sum_rounded_up(from[axis], up[axis]);
    }
    return box;
  }
};

bool contains(const Aabb& box, const Vec3& point) {
  return (box.low.array() <= point.array()).all() && (point.array() <= box.high.array()).all();
}

/// Far enough from underflow and overflow that only the usual roundings apply.
bool is_plain(double length) { return length > kSmallestPlain && length < kLargestPlain; }

QuestionExtent extent_of(const Ray& ray) {
  QuestionExtent extent{.from = ray.origin};
  const double length = stable_length(ray.direction);
  for (int axis = 0; axis < 3; ++axis) {
    const double along = ray.direction[axis];
    if (along == 0 || ray.length_m == 0) continue;
    const bool is_along_axis = ray.direction[(axis + 1) % 3] == 0 && ray.direction[(axis + 2) % 3] == 0;
    // If the length itself is imprecise, or the ray is along an axis, the whole length is taken for the share.
    const bool is_part = is_plain(length) && !is_along_axis;
    const double reach_m = is_part ? std::abs(along) / length * ray.length_m * (1 + kRaySlack) : ray.length_m;
    (along < 0 ? extent.down : extent.up)[axis] = reach_m;
  }
  return extent;
}

QuestionExtent extent_of(const Vec3& center, double radius_m) {
  return {.from = center, .down = Vec3::Constant(radius_m), .up = Vec3::Constant(radius_m)};
}

/// For bounds that were rounded outward: the differences from the point `from` are rounded outward again.
QuestionExtent extent_of(const Vec3& from, const Aabb& bounds) {
  const auto outward = [](double x) { return x == 0 ? 0 : std::nextafter(x, kEndless); };
  return {.from = from, .down = (from - bounds.low).unaryExpr(outward), .up = (bounds.high - from).unaryExpr(outward)};
}

QuestionExtent extent_of_box(const double* n) {
  const bool is_turned = n[7] != 0 || n[8] != 0 || n[9] != 0;
  if (is_turned) return extent_of(point_of(n), bounds(box_of(n)));
  return {.from = point_of(n), .down = {n[3], n[4], n[5]}, .up = {n[3], n[4], n[5]}};
}

/// The sweep up to its contact, if there is one.
QuestionExtent extent_of_sweep(const ObjectInfo& mover, const double* n, const std::optional<TimeBracket>& contact) {
  const Vec3 from = point_of(n);
  const Vec3 to = point_of(n + kPoseNumbers);
  const double part = contact ? std::min(1.0, contact->low * (1 + kSlack) + kSlack) : 1;
  Aabb motion;
  motion.extend(from);
  motion.extend(part == 1 ? to : Vec3(from + part * (to - from)));
  const double roundings_m = kChainSlack * from.cwiseAbs().cwiseMax(to.cwiseAbs()).maxCoeff();
  return extent_of(from, grown(motion, reach_of(mover) * (1 + kSlack) + (part == 1 ? 0 : roundings_m)));
}

/// How far a ray that starts in the box stays in it; slightly less, to cover rounding.
double length_within(const Ray& ray, const Aabb& box) {
  const double length = stable_length(ray.direction);
  double within_m = ray.length_m;
  for (int axis = 0; axis < 3; ++axis) {
    const double unit = ray.direction[axis] / length;
    if (unit == 0) continue;
    const double left_m = unit < 0 ? ray.origin[axis] - box.low[axis] : box.high[axis] - ray.origin[axis];
    within_m = std::min(within_m, left_m / std::abs(unit) * (1 - kSlack));
  }
  return within_m;
}

/// A hit's answer holds for anything as near as its bound allows, so space must be covered only up to there.
double nearest(const AnswerHit& hit) { return std::max(0.0, hit.distance_m - hit.error_m); }

/// The length of the ray on which the answer depends.
double length_claimed(const Questions& asked, const double* n, std::span<const AnswerHit> hits) {
  if (asked.mode == HitMode::all || hits.empty()) return n[6];
  if (asked.mode == HitMode::any) return 0;
  return std::min(n[6], nearest(hits.front()));
}

/// An answer with max_hits hits does not depend on anything beyond the last one.
double reach_claimed(const Questions& asked, const double* n, std::span<const AnswerHit> hits) {
  if (hits.empty() || hits.size() < asked.max_hits) return n[3];
  return std::min(n[3], nearest(hits.back()));
}

std::optional<Leaving> leaves(const QuestionExtent& extent, std::span<const Aabb> covers) {
  if (extent.is_in_one_of(covers)) return std::nullopt;
  const std::optional<Aabb> outside = nearest_part_outside(extent.around(), covers, extent.from);
  if (!outside) return std::nullopt;
  return Leaving{.point = nearest_in(*outside, extent.from), .covered_m = 0};
}

/// A box around the ray's points between two lengths, grown by the rounding of both.
Aabb stretch(const Ray& ray, double from_m, double to_m) {
  const Vec3 unit = ray.direction / stable_length(ray.direction);
  Aabb points;
  points.extend(Vec3(ray.origin + from_m * unit));
  points.extend(Vec3(ray.origin + to_m * unit));
  for (int axis = 0; axis < 3; ++axis) {
    if (ray.direction[axis] == 0) continue;
    const double roundings_m = kChainSlack * (std::abs(ray.origin[axis]) + to_m);
    points.low[axis] -= roundings_m;
    points.high[axis] += roundings_m;
  }
  return points;
}

/// How far along the ray the farthest-reaching single box extends that contains the ray's point at at_m.
double farthest_in_one(const Ray& ray, double at_m, std::span<const Aabb> covers) {
  const Aabb here = at_m == 0 ? Aabb{ray.origin, ray.origin} : stretch(ray, at_m, at_m);
  double farthest_m = at_m;
  for (const Aabb& box : covers) {
    if (contains(box, here.low) && contains(box, here.high)) farthest_m = std::max(farthest_m, length_within(ray, box));
  }
  return farthest_m;
}

/// Goes from box to box: a section across each border, longer than the rounding, must lie in the union of the boxes.
double length_covered(const Ray& ray, std::span<const Aabb> covers) {
  constexpr int kMostBoxes = 1'000;
  double at_m = 0;
  for (int i = 0; i < kMostBoxes; ++i) {
    const double farthest_m = farthest_in_one(ray, at_m, covers);
    if (farthest_m >= ray.length_m || farthest_m == at_m) return farthest_m;
    const double scale_m = ray.origin.cwiseAbs().maxCoeff() + farthest_m;
    const double beyond_m = std::min(farthest_m + 4 * kSlack * scale_m, ray.length_m);
    if (nearest_part_outside(stretch(ray, farthest_m, beyond_m), covers, ray.origin)) return farthest_m;
    at_m = beyond_m;
    if (at_m == ray.length_m) return at_m;
  }
  return at_m;
}

}  // namespace

std::optional<Leaving> leaves_covered(const Ray& ray, std::span<const Aabb> covers) {
  const QuestionExtent extent = extent_of(ray);
  if (extent.is_in_one_of(covers)) return std::nullopt;
  const bool is_along_axis = (ray.direction.array() != 0).count() == 1;
  if (is_along_axis && !nearest_part_outside(extent.around(), covers, ray.origin)) return std::nullopt;
  const double length = stable_length(ray.direction);
  if (!is_plain(length)) return Leaving{.point = ray.origin, .covered_m = 0};
  const double covered_m = length_covered(ray, covers);
  if (!is_along_axis && covered_m >= ray.length_m) return std::nullopt;
  return Leaving{.point = ray.origin + covered_m * (ray.direction / length), .covered_m = covered_m};
}

namespace {

/// What an answer depends on: its hits if they are reported, and a sweep's bracket.
struct Claim {
  std::span<const AnswerHit> hits;
  bool is_hit = false;
  std::optional<TimeBracket> bracket = {};
};

std::optional<Leaving> leaves_covered(const Questions& asked, const double* n, const Claim& claim,
                                      std::span<const Aabb> covers) {
  switch (asked.kind) {
    case QuestionKind::ray: {
      if (asked.mode == HitMode::any && claim.is_hit) return std::nullopt;
      Ray claimed = ray_of(n);
      claimed.length_m = length_claimed(asked, n, claim.hits);
      return leaves_covered(claimed, covers);
    }
    case QuestionKind::sphere: return claim.is_hit ? std::nullopt : leaves(extent_of(point_of(n), n[3]), covers);
    case QuestionKind::inside: return claim.is_hit ? std::nullopt : leaves(extent_of(point_of(n), 0), covers);
    case QuestionKind::box: return claim.is_hit ? std::nullopt : leaves(extent_of_box(n), covers);
    case QuestionKind::near: return leaves(extent_of(point_of(n), reach_claimed(asked, n, claim.hits)), covers);
    case QuestionKind::sweep: return leaves(extent_of_sweep(*asked.mover, n, claim.bracket), covers);
    default: return std::nullopt;
  }
}

}  // namespace

std::optional<Leaving> leaves_covered(const Question& question, const double* n) {
  const Claim claim{.hits = question.found, .is_hit = !question.found.empty(), .bracket = question.bracket};
  return leaves_covered(question.asked, n, claim, *question.snapshot.covers);
}

void doubt_where_not_held(const Snapshot& snapshot, const Questions& asked, Answers& answers) {
  if (!snapshot.covers_without_places) return;
  const std::uint32_t stride = numbers_of(asked.kind);
  const std::size_t covered_before = answers.not_covered.size();
  std::size_t first_hit = 0;
  for (std::size_t i = 0; i < answers.answers.size(); ++i) {
    const std::size_t hit = std::exchange(first_hit, first_hit + answers.hit_counts[i]);
    const bool is_hit = answers.answers[i] == Verdict::hit;
    if (!is_hit && answers.answers[i] != Verdict::miss) continue;
    Claim claim{.hits = std::span(answers.hits).subspan(hit, answers.hit_counts[i]), .is_hit = is_hit};
    if (is_hit && !answers.brackets.empty()) claim.bracket = answers.brackets[hit];
    const std::optional<Leaving> leaving = leaves_covered(asked, &asked.numbers[i * stride], claim, *snapshot.covers);
    if (!leaving) continue;
    answers.answers[i] = Verdict::undecided;
    answers.reasons[i] = UndecidedReason::not_covered;
    answers.not_covered.push_back({.question = static_cast<std::uint32_t>(i), .leaving = *leaving});
  }
  // Keeps the order of the questions, including those not covered for another reason.
  if (covered_before > 0) std::ranges::sort(answers.not_covered, {}, &NotCovered::question);
}

}  // namespace collided::engine
