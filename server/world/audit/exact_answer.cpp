#include "server/world/audit/exact_answer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/given/given_ray.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/geometry/guess_tolerance.hpp"
#include "server/world/objects/parts.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/solids/solid.hpp"
#include "server/world/solids/winding.hpp"

namespace collided::engine {

namespace {

/// The rounding of the comparison itself, relative: a smaller difference is not reported.
constexpr double kComparing = 0x1p-50;

/// Relative margins for parts left out of the exact comparison, each many roundings wide: a part kept in vain only
/// costs time. The first is a share of a box's half diagonal, the second of its coordinates.
constexpr double kPassesByMargin = 1e-6;
constexpr double kBoundsMargin = 1e-12;
/// Lengths below this have lost digits to underflow: in doubt.
constexpr double kLeastSureLength = 1e-100;

/// True if certainly farther from the line than the box reaches, with a margin of many roundings.
bool passes_by(const Ray& ray, const Aabb& box) {
  const Vec3 middle = box.low / 2 + box.high / 2;
  const Vec3 direction = ray.direction / ray.direction.lpNorm<Eigen::Infinity>();
  const Vec3 away = middle - ray.origin;
  const double radius = (box.high - box.low).norm() * (0.5 + kPassesByMargin) +
                        kSearchMargin * (away.norm() + middle.norm() + ray.origin.norm());
  const double across = away.cross(direction).norm() / direction.norm();
  return across > radius && std::isfinite(across) && std::isfinite(radius) && radius > kLeastSureLength;
}

/// The least distance from a point to a box, less a margin of many roundings.
double distance_at_least(const Vec3& point, const Aabb& box) {
  const Vec3 outside = (box.low - point).cwiseMax(point - box.high).cwiseMax(Vec3::Zero());
  const double distance = outside.norm() * (1 - kSearchMargin);
  return std::isfinite(distance) && distance > kLeastSureLength ? distance : 0;
}

/// For the numbers as given, by rationals.
template <class Shape>
Decision touches(const Primitive& asked, const GivenPart& given_asked, const Shape& shape, const GivenPart& given) {
  const GivenPair pair{given_asked, given};
  if (pair.is_exact()) return exactly::overlaps(asked, shape);
  const Decision as_given = overlaps_as_given(as_part(asked), as_part(shape), pair);
  return as_given == Decision::undecided ? exactly::overlaps(asked, shape) : as_given;
}

/// Bounds with a margin of many roundings.
template <class Shape>
Aabb wide_bounds(const Shape& shape) {
  const Aabb box = bounds(shape);
  const Vec3 margin = kBoundsMargin * box.low.cwiseAbs().cwiseMax(box.high.cwiseAbs());
  return {.low = box.low - margin, .high = box.high + margin};
}

bool truncated(const Answers& given) { return given.reasons[0] == UndecidedReason::truncated; }

template <class Name>
void keep_nearer(std::map<Name, Interval>& known, const Name& name, const Interval& at) {
  const auto [before, is_new] = known.try_emplace(name, at);
  if (!is_new && at.high < before->second.high) before->second = at;
}

template <class Name>
std::optional<Interval> nearest_of(const std::map<Name, Interval>& known) {
  if (known.empty()) return std::nullopt;
  const auto by_distance = [](const auto& a, const auto& b) { return a.second.high < b.second.high; };
  return std::min_element(known.begin(), known.end(), by_distance)->second;
}

}  // namespace

bool may_be_equal(const Interval& a, const Interval& b) {
  const double slack = kComparing * (std::abs(a.high) + std::abs(b.high));
  return a.low <= b.high + slack && b.low <= a.high + slack;
}

ExactAnswer::ExactAnswer(const Snapshot& snapshot, const Questions& question, double far_m) : question_(question) {
  const OwnFloatEnvironment own_floats;
  const double* numbers = question.numbers.data();
  switch (question.kind) {
    case QuestionKind::ray: cast_ray(snapshot); break;
    case QuestionKind::sphere: {
      const Sphere asked = sphere_of(numbers);
      find_touched(snapshot, asked, {}, bounds(asked));
      break;
    }
    case QuestionKind::box: {
      const BoxQuestionShape asked(numbers);
      find_touched(snapshot, asked.placed(), asked.given(), asked.bounds());
      break;
    }
    case QuestionKind::near: find_nearest(snapshot, far_m); break;
    case QuestionKind::inside: {
      find_touched(snapshot, Sphere{.center = point_of(numbers), .radius_m = 0}, {},
                   bounds(Sphere{point_of(numbers), 0}));
      break;
    }
    default: return;
  }
}

bool ExactAnswer::allowed(const Snapshot& snapshot, ObjectId id) const {
  return may_answer(*snapshot.objects[slot_of(id)], question_);
}

void ExactAnswer::cast_ray(const Snapshot& snapshot) {
  const Ray ray = ray_of(question_.numbers.data());
  for (const ObjectId object : holders(snapshot, SolidSide::in))
    keep_nearer(met_, PartName{object, kNoTriangle}, Interval(0, 0));
  visit_parts(snapshot, [&](ObjectId object, std::uint32_t triangle, const auto& shape, const GivenPart& given) {
    if (!allowed(snapshot, object) || passes_by(ray, bounds(shape))) return;
    RayHit hit;
    ExactResult meets{exactly::cast_ray(ray, shape, hit), Level::rational};
    const double off_m = given.placing_error_m(ray.origin.lpNorm<1>());
    if (off_m > 0) meets = ray_as_given(ray, as_part(shape), given, off_m, meets, hit);
    if (!meets.yes()) return;
    keep_nearer(met_, PartName{object, triangle}, Interval(hit.distance_m, hit.distance_error_m));
  });
}

std::vector<ObjectId> ExactAnswer::holders(const Snapshot& snapshot, SolidSide least) const {
  std::vector<ObjectId> found;
  const Vec3 point = point_of(question_.numbers.data());
  for (const auto& info : snapshot.objects) {
    if (!info || !info->rare->solid || !allowed(snapshot, info->id)) continue;
    const Placed placed = placed_in(snapshot, slot_of(info->id));
    if (side_by_rationals(*info->rare->solid, placed, point) >= least) found.push_back(info->id);
  }
  return found;
}

std::vector<ObjectId> ExactAnswer::by_winding(const Snapshot& snapshot, WindingSide asked) const {
  std::vector<ObjectId> found;
  for (const auto& info : snapshot.objects) {
    if (!info || !info->rare->winding || !allowed(snapshot, info->id)) continue;
    const Placed placed = placed_in(snapshot, slot_of(info->id));
    if (side_by_winding_sum(*info->rare->winding, placed, point_of(question_.numbers.data())) == asked)
      found.push_back(info->id);
  }
  return found;
}

void ExactAnswer::find_touched(const Snapshot& snapshot, const Primitive& asked, const GivenPart& given_asked,
                               const Aabb& near) {
  for (const ObjectId object : holders(snapshot, SolidSide::on)) touched_.insert(object);
  const bool only_solids = question_.kind == QuestionKind::inside;
  if (only_solids) {
    for (const ObjectId object : by_winding(snapshot, WindingSide::in)) touched_.insert(object);
    for (const ObjectId object : by_winding(snapshot, WindingSide::undecided)) doubtful_.insert(object);
  }
  visit_parts(snapshot, [&](ObjectId object, std::uint32_t triangle, const auto& shape, const GivenPart& given) {
    if (only_solids && triangle != kNoTriangle) return;
    if (!allowed(snapshot, object) || touched_.contains(object) || !overlaps(near, wide_bounds(shape))) return;
    const Decision touching = touches(asked, given_asked, shape, given);
    if (touching == Decision::yes) touched_.insert(object);
    if (touching == Decision::undecided) doubtful_.insert(object);
  });
}

void ExactAnswer::find_nearest(const Snapshot& snapshot, double far_m) {
  const Vec3 point = point_of(question_.numbers.data());
  const double reach_m = question_.numbers[3];
  for (const ObjectId object : holders(snapshot, SolidSide::on)) keep_nearer(distances_, object, Interval(0, 0));
  if (question_.mode == HitMode::signed_near) {
    for (const ObjectId object : by_winding(snapshot, WindingSide::in)) keep_nearer(distances_, object, Interval(0, 0));
  }
  const bool is_open = far_m == std::numeric_limits<double>::infinity() && question_.max_hits == 1;
  visit_parts(snapshot, [&](ObjectId object, std::uint32_t, const auto& shape, const GivenPart& given) {
    if (!allowed(snapshot, object) || distance_at_least(point, bounds(shape)) > far_m * (1 + kSearchMargin)) return;
    if (std::isfinite(reach_m) && touches(Sphere{point, reach_m}, {}, shape, given) != Decision::yes) return;
    const Closest nearest = exactly::closest(point, shape);
    const Interval at(nearest.distance_m, nearest.distance_error_m + given.placing_error_m(point.lpNorm<1>()));
    keep_nearer(distances_, object, at);
    // Nothing beyond the nearest so far is needed.
    if (is_open) far_m = std::min(far_m, at.high);
  });
}

std::optional<Interval> ExactAnswer::first() const {
  return question_.kind == QuestionKind::ray ? nearest_of(met_) : nearest_of(distances_);
}

bool ExactAnswer::are_touched(const std::set<ObjectId>& objects) const {
  return std::includes(objects.begin(), objects.end(), touched_.begin(), touched_.end()) &&
         std::all_of(objects.begin(), objects.end(),
                     [&](ObjectId id) { return touched_.contains(id) || doubtful_.contains(id); });
}

std::string ExactAnswer::difference(const Answers& given) const {
  if (!question_.with_hits) return difference_of_verdict(given.answers[0]);
  switch (question_.kind) {
    case QuestionKind::ray: return difference_of_ray(given);
    case QuestionKind::sphere:
    case QuestionKind::inside:
    case QuestionKind::box: return difference_of_overlaps(given);
    case QuestionKind::near: return difference_of_near(given);
    default: return {};
  }
}

std::string ExactAnswer::difference_of_verdict(Verdict given) const {
  const bool is_met = !met_.empty() || !touched_.empty();
  const bool may_be_met = is_met || !doubtful_.empty();
  if (given == Verdict::hit && !may_be_met) return "nothing is met, answered was a hit";
  if (given == Verdict::miss && is_met) return "something is met, answered was a miss";
  return {};
}

std::string ExactAnswer::difference_of_ray(const Answers& given) const {
  if (met_.empty() != given.hits.empty()) {
    return fmt::format("{} parts are met, {} were answered", met_.size(), given.hits.size());
  }
  for (const AnswerHit& hit : given.hits) {
    if (!met_.contains({hit.object, hit.triangle})) {
      return fmt::format("object {} triangle {} is not met", hit.object, hit.triangle);
    }
  }
  if (question_.mode == HitMode::closest && !met_.empty()) return difference_of_first(given.hits[0]);
  if (question_.mode == HitMode::all && !truncated(given)) {
    std::set<PartName> parts;
    for (const AnswerHit& hit : given.hits) parts.insert({hit.object, hit.triangle});
    if (parts.size() != met_.size())
      return fmt::format("{} parts are met, {} were answered", met_.size(), parts.size());
  }
  return {};
}

std::string ExactAnswer::difference_of_first(const AnswerHit& hit) const {
  const Interval nearest = *nearest_of(met_);
  const Interval given(hit.distance_m, hit.error_m);
  if (!may_be_equal(given, nearest)) {
    return fmt::format("the first hit is at [{:.17g}, {:.17g}] m, answered was {:.17g} +- {:.3g} m", nearest.low,
                       nearest.high, hit.distance_m, hit.error_m);
  }
  const Interval own = met_.at({hit.object, hit.triangle});
  if (may_be_equal(given, own)) return {};
  return fmt::format("object {} triangle {} is at [{:.17g}, {:.17g}] m, answered was {:.17g} m", hit.object,
                     hit.triangle, own.low, own.high, hit.distance_m);
}

std::string ExactAnswer::difference_of_overlaps(const Answers& given) const {
  std::set<ObjectId> objects;
  for (const AnswerHit& hit : given.hits) objects.insert(hit.object);
  for (const ObjectId object : objects) {
    if (!touched_.contains(object) && !doubtful_.contains(object))
      return fmt::format("object {} is not touched", object);
  }
  if (question_.mode == HitMode::any && !objects.empty()) return {};  // one is enough
  const bool all_given = std::includes(objects.begin(), objects.end(), touched_.begin(), touched_.end());
  if (all_given || truncated(given)) return {};
  return fmt::format("{} objects are touched, {} were answered", touched_.size(), objects.size());
}

std::string ExactAnswer::difference_of_near(const Answers& given) const {
  std::vector<Interval> nearest;
  for (const auto& [object, at] : distances_) nearest.push_back(at);
  std::sort(nearest.begin(), nearest.end(), [](const Interval& a, const Interval& b) { return a.high < b.high; });
  const std::size_t expected = std::min<std::size_t>(nearest.size(), question_.max_hits);
  if (given.hits.size() != expected) {
    return fmt::format("{} objects are in reach, {} were answered", expected, given.hits.size());
  }
  for (std::size_t i = 0; i < expected; ++i) {
    const AnswerHit& hit = given.hits[i];
    const auto own = distances_.find(hit.object);
    // A depth is reported instead of 0; only the presence of the object is judged.
    const bool is_depth = question_.mode == HitMode::signed_near && hit.distance_m < 0;
    const Interval at = is_depth ? Interval(0, 0) : Interval(hit.distance_m, hit.error_m);
    if (own == distances_.end() || !may_be_equal(at, own->second) || !may_be_equal(at, nearest[i])) {
      return fmt::format("object {} of the nearest is at [{:.17g}, {:.17g}] m, answered was {:.17g} +- {:.3g} m", i,
                         nearest[i].low, nearest[i].high, hit.distance_m, hit.error_m);
    }
  }
  return {};
}

}  // namespace collided::engine
