#include "server/world/query/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

#include "server/exact_phase/exactly.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/world/objects/parts.hpp"
#include "server/world/query/question_shapes.hpp"

namespace collided::engine {
namespace {

using PartName = std::pair<ObjectId, std::uint32_t>;

/// A range that contains the true number.
struct Interval {
  double low = 0;
  double high = 0;

  Interval(double value, double error) : low(value - error), high(value + error) {}
};

/// The relative roundings of the comparison itself: a smaller difference is no finding.
constexpr double kComparing = 0x1p-50;

bool may_be_equal(const Interval& a, const Interval& b) {
  const double slack = kComparing * (std::abs(a.high) + std::abs(b.high));
  return a.low <= b.high + slack && b.low <= a.high + slack;
}

/// The box is surely farther from the line than its own extent, with a margin of many roundings. False when in doubt.
bool passes_by(const Ray& ray, const Aabb& box) {
  const Vec3 middle = box.low / 2 + box.high / 2;
  const Vec3 direction = ray.direction / ray.direction.lpNorm<Eigen::Infinity>();
  const Vec3 away = middle - ray.origin;
  const double radius =
      (box.high - box.low).norm() * (0.5 + 1e-6) + 1e-9 * (away.norm() + middle.norm() + ray.origin.norm());
  const double across = away.cross(direction).norm() / direction.norm();
  return across > radius && std::isfinite(across) && std::isfinite(radius) && radius > 1e-100;
}

/// The least distance from a point to a box in metres, less a margin of many roundings.
double distance_at_least(const Vec3& point, const Aabb& box) {
  const Vec3 outside = (box.low - point).cwiseMax(point - box.high).cwiseMax(Vec3::Zero());
  const double distance = outside.norm() * (1 - 1e-9);
  return std::isfinite(distance) && distance > 1e-100 ? distance : 0;
}

/// Checks one answer against the parts of the snapshot; run() returns the first difference found.
class Auditor {
 public:
  Auditor(const Snapshot& snapshot, const Questions& question, const Answers& given)
      : snapshot_(snapshot), question_(question), given_(given), numbers_(question.numbers.data()) {}

  std::string run() {
    switch (question_.kind) {
      case QuestionKind::ray: check_ray(); break;
      case QuestionKind::sphere: check_overlaps(sphere_of(numbers_)); break;
      case QuestionKind::box: check_overlaps(box_of(numbers_)); break;
      case QuestionKind::near: check_near(); break;
      default: break;
    }
    return std::move(finding_);
  }

 private:
  void differs(const std::string& what) {
    finding_ = fmt::format("{} {:.17g}: {}", name_of(question_.kind), fmt::join(question_.numbers, " "), what);
  }
  bool allowed(ObjectId id) const { return may_answer(*(*snapshot_.objects)[slot_of(id)], question_); }
  bool truncated() const { return given_.reasons[0] == UndecidedReason::truncated; }

  /// The given hits must all be met, and none may be missing where the mode claims completeness.
  void check_ray();
  /// The nearest of the parts met must be the one answered, at its own distance.
  void check_first(const std::map<PartName, Interval>& met);
  template <class Asked>
  void check_overlaps(const Asked& asked);
  void check_near();

  const Snapshot& snapshot_;
  const Questions& question_;
  const Answers& given_;
  const double* numbers_;
  std::string finding_;
};

void Auditor::check_ray() {
  const Ray ray = ray_of(numbers_);
  std::map<PartName, Interval> met;
  visit_parts(snapshot_, [&](ObjectId object, std::uint32_t triangle, const auto& shape) {
    if (!allowed(object) || passes_by(ray, bounds(shape))) return;
    RayHit hit;
    if (exactly::cast_ray(ray, shape, hit) != Decision::yes) return;
    const Interval at(hit.distance_m, hit.distance_error_m);
    const auto [known, is_new] = met.try_emplace(PartName{object, triangle}, at);
    if (!is_new && at.high < known->second.high) known->second = at;
  });
  if (met.empty() != given_.hits.empty()) {
    return differs(fmt::format("{} parts are met, {} were answered", met.size(), given_.hits.size()));
  }
  for (const AnswerHit& hit : given_.hits) {
    if (!met.contains({hit.object, hit.triangle})) {
      return differs(fmt::format("object {} triangle {} is not met", hit.object, hit.triangle));
    }
  }
  if (question_.mode == HitMode::closest && !met.empty()) check_first(met);
  if (question_.mode == HitMode::all && !truncated()) {
    std::set<PartName> given;
    for (const AnswerHit& hit : given_.hits) given.insert({hit.object, hit.triangle});
    if (given.size() != met.size()) {
      differs(fmt::format("{} parts are met, {} were answered", met.size(), given.size()));
    }
  }
}

void Auditor::check_first(const std::map<PartName, Interval>& met) {
  const auto by_distance = [](const auto& a, const auto& b) { return a.second.high < b.second.high; };
  const Interval first = std::min_element(met.begin(), met.end(), by_distance)->second;
  const AnswerHit& hit = given_.hits[0];
  const Interval given(hit.distance_m, hit.error_m);
  if (!may_be_equal(given, first)) {
    return differs(fmt::format("the first hit is at [{:.17g}, {:.17g}] m, answered was {:.17g} +- {:.3g} m", first.low,
                               first.high, hit.distance_m, hit.error_m));
  }
  const Interval own = met.at({hit.object, hit.triangle});
  if (!may_be_equal(given, own)) {
    differs(fmt::format("object {} triangle {} is at [{:.17g}, {:.17g}] m, answered was {:.17g} m", hit.object,
                        hit.triangle, own.low, own.high, hit.distance_m));
  }
}

/// In either order of the two kinds of shape.
Decision touches(const Primitive& asked, const Triangle& shape) { return exactly::overlaps(asked, shape); }
Decision touches(const Primitive& asked, const Primitive& shape) { return exactly::overlaps(asked, shape); }

template <class Asked>
void Auditor::check_overlaps(const Asked& asked) {
  const Aabb near = bounds(asked);
  std::set<ObjectId> touched;
  std::set<ObjectId> doubtful;  // round parts that nearly touch: rational arithmetic cannot decide these
  visit_parts(snapshot_, [&](ObjectId object, std::uint32_t, const auto& shape) {
    if (!allowed(object) || touched.contains(object) || !overlaps(near, bounds(shape))) return;
    const Decision touching = touches(asked, shape);
    if (touching == Decision::yes) touched.insert(object);
    if (touching == Decision::undecided) doubtful.insert(object);
  });
  std::set<ObjectId> given;
  for (const AnswerHit& hit : given_.hits) given.insert(hit.object);
  for (const ObjectId object : given) {
    if (!touched.contains(object) && !doubtful.contains(object)) {
      return differs(fmt::format("object {} is not touched", object));
    }
  }
  if (question_.mode == HitMode::any && !given.empty()) return;  // mode `any` claims one object only
  const bool all_given = std::includes(given.begin(), given.end(), touched.begin(), touched.end());
  if (!all_given && !truncated()) {
    differs(fmt::format("{} objects are touched, {} were answered", touched.size(), given.size()));
  }
}

void Auditor::check_near() {
  const Vec3 point = point_of(numbers_);
  const double reach_m = numbers_[3];
  const bool full = given_.hits.size() >= question_.max_hits;
  // Nothing beyond the last answered hit can contradict a full answer.
  const double far_m = full ? given_.hits.back().distance_m + given_.hits.back().error_m : reach_m;
  std::map<ObjectId, Interval> distances;
  visit_parts(snapshot_, [&](ObjectId object, std::uint32_t, const auto& shape) {
    if (!allowed(object) || distance_at_least(point, bounds(shape)) > far_m * (1 + 1e-9)) return;
    if (std::isfinite(reach_m) && exactly::overlaps(Sphere{point, reach_m}, shape) != Decision::yes) return;
    const Closest nearest = exactly::closest(point, shape);
    const Interval at(nearest.distance_m, nearest.distance_error_m);
    const auto [known, is_new] = distances.try_emplace(object, at);
    if (!is_new && at.high < known->second.high) known->second = at;
  });
  std::vector<Interval> nearest;
  for (const auto& [object, at] : distances) nearest.push_back(at);
  std::sort(nearest.begin(), nearest.end(), [](const Interval& a, const Interval& b) { return a.high < b.high; });
  const std::size_t expected = std::min<std::size_t>(nearest.size(), question_.max_hits);
  if (given_.hits.size() != expected) {
    return differs(fmt::format("{} objects are in reach, {} were answered", expected, given_.hits.size()));
  }
  for (std::size_t i = 0; i < expected; ++i) {
    const AnswerHit& hit = given_.hits[i];
    const auto own = distances.find(hit.object);
    const Interval given(hit.distance_m, hit.error_m);
    if (own == distances.end() || !may_be_equal(given, own->second) || !may_be_equal(given, nearest[i])) {
      return differs(
          fmt::format("object {} of the nearest is at [{:.17g}, {:.17g}] m, answered was {:.17g} +- {:.3g} m", i,
                      nearest[i].low, nearest[i].high, hit.distance_m, hit.error_m));
    }
  }
}

}  // namespace

std::string audit(const Snapshot& snapshot, const Questions& question, const Answers& given) {
  const OwnFloatEnvironment own_floats;
  const bool claims = given.answers[0] == Verdict::hit || given.answers[0] == Verdict::miss ||
                      given.reasons[0] == UndecidedReason::truncated;
  return claims ? Auditor(snapshot, question, given).run() : std::string();
}

}  // namespace collided::engine
