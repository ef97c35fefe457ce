#include "server/world/explain/ray_misses.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <collided/explanations.hpp>

#include "server/geometry/tolerance.hpp"
#include "server/world/groups/object_clearance.hpp"
#include "server/world/objects/object_placing.hpp"
#include "server/world/query/question_shapes.hpp"
#include "server/world/query/ray_entry.hpp"

namespace collided::engine {
namespace {

constexpr double kRounding = 1e-12;  // relative; lengths that only order or bound the search lose far less

bool is_finite(const Aabb& box) { return box.low.allFinite() && box.high.allFinite(); }

/// A box around the bounded parts of the object: all but its half-spaces.
Aabb bounded_part(const Placed& object) {
  if (is_finite(object.bounds)) return object.bounds;
  Aabb box;
  for (const Primitive& own : object.info->primitives) {
    const Aabb one = bounds(place(object.frame, own));
    if (is_finite(one)) box.extend(one);
  }
  if (object.info->mesh) {
    Aabb around{.low = object.frame.position, .high = object.frame.position};
    box.extend(grown(around, object.info->mesh->radius_m));
  }
  return box;
}

}  // namespace

RayMisses::RayMisses(const Snapshot& snapshot, const RayExplanationAsk& ask, PartMeshes& part_meshes)
    : snapshot_(snapshot),
      ask_(ask),
      ray_(ray_of(ask.numbers.data())),
      unit_(ray_.direction.stableNormalized()),
      members_(snapshot, part_meshes) {}

void RayMisses::look_at_boxes(const std::unordered_set<ObjectId>& met, ExplainedRay& told) {
  const Questions asked = ask_.questions();
  for (const auto& info : snapshot_.objects) {
    if (!info) continue;
    ++told.objects;
    const std::uint32_t number = members_.add(info->id);
    const Aabb& box = members_.bounds(number);
    const bool is_met = !box.empty() && entry_of(ray_, box) < kNoLimit_m;
    if (info->is_unknown) {
      if (is_met) told.unknown.push_back(info->name);
      continue;
    }
    const bool is_left_out = !may_answer(*info, asked);
    if (is_left_out) ++told.left_out_count;
    else if (is_met) ++told.boxes_met;
    const bool is_told = !is_left_out || ask_.why_not == info->id;
    if (is_told && !box.empty() && !met.contains(info->id))
      passed_.push_back({number, least_distance_m(box), is_met, is_left_out});
  }
}

/// Lower bound by the ball around the box, or by the boxes if the ball gives none.
double RayMisses::least_distance_m(const Aabb& box) const {
  if (!is_finite(box)) return 0;
  const Vec3 middle = 0.5 * (box.low + box.high) - ray_.origin;
  const double along_m = std::clamp(middle.dot(unit_), 0.0, ray_.length_m);
  const double apart_m = (middle - along_m * unit_).norm();
  const double slack_m = kRounding * (middle.norm() + ray_.origin.norm() + box.low.norm() + box.high.norm());
  const double least_m = apart_m - 0.5 * (box.high - box.low).norm() - slack_m;
  return least_m > 0 ? least_m : 0;
}

/// No point of the ray beyond this is nearer to the object.
double RayMisses::reach_m(const Aabb& box) const {
  if (box.empty()) return 0;
  const Vec3 low = (box.low - ray_.origin).cwiseProduct(unit_);
  const Vec3 high = (box.high - ray_.origin).cwiseProduct(unit_);
  const double farthest_m = low.cwiseMax(high).sum() + kRounding * (low.lpNorm<1>() + high.lpNorm<1>());
  return std::clamp(farthest_m, 0.0, ray_.length_m);
}

void RayMisses::find(Deadline& deadline, ExplainedRay& told) {
  std::stable_sort(passed_.begin(), passed_.end(),
                   [](const Passed& a, const Passed& b) { return a.at_least_m < b.at_least_m; });
  const auto nearer = [](const ExplainedMiss& a, const ExplainedMiss& b) { return a.distance_m < b.distance_m; };
  std::optional<ExplainedMiss> asked_for;
  const std::string_view why_not = ask_.why_not ? snapshot_.objects[slot_of(*ask_.why_not)]->name : std::string_view();
  const bool is_told = std::any_of(told.left_out.begin(), told.left_out.end(),
                                   [&](const ExplainedMeeting& meeting) { return why_not == meeting.object; });
  // If some test was undecided or not reported, whatever meets the segment may meet the ray.
  is_any_open_ = told.cut || told.reason == collided::UndecidedReason::numeric;
  for (const Passed& passed : passed_) {
    const bool is_asked_for = !is_told && ask_.why_not == members_.info(passed.number).id;
    const bool is_full = told.misses.size() >= ask_.most_misses;
    const double limit_m = is_full ? (told.misses.empty() ? -1 : told.misses.back().distance_m) : kNoLimit_m;
    if (!is_asked_for && (passed.at_least_m > limit_m || passed.is_left_out)) continue;
    const std::optional<ExplainedMiss> miss = miss_of(passed, is_asked_for ? kNoLimit_m : limit_m, deadline);
    if (deadline.was_over()) break;
    if (!miss) continue;
    if (is_asked_for) {
      asked_for = miss;
      continue;
    }
    told.misses.insert(std::upper_bound(told.misses.begin(), told.misses.end(), *miss, nearer), *miss);
    if (told.misses.size() > ask_.most_misses) told.misses.pop_back();
  }
  if (asked_for) told.misses.push_back(*asked_for);
}

/// The distance of the object from the part of the ray that can be nearest to it; nothing if beyond the limit.
std::optional<ExplainedMiss> RayMisses::miss_of(const Passed& passed, double limit_m, Deadline& deadline) {
  const Placed& object = members_.placed(passed.number, deadline);
  const double length_m = reach_m(bounded_part(object));
  const Vec3 end = ray_.origin + length_m * unit_;
  // Same error as that of a hit: the direction, the product and the sum are rounded.
  const double end_error_m =
      (kPointOnRay * length_m + kPointSum * end.cwiseAbs().maxCoeff()) * (1 + kBoundSlack) + kUnderflow;
  ObjectInfo line;
  line.primitives = {Capsule{.a = ray_.origin, .b = end, .radius_m = 0}};
  const Pose world_pose;
  const Frame world;
  const Placed segment{.info = &line, .frame = world, .bounds = bounds_of(line, world), .pose = &world_pose};
  WalkCost cost;
  const std::optional<ObjectClearance> found =
      clearance_between(segment, object, {.limit_m = limit_m, .depth = false}, cost, deadline);
  if (!found) return std::nullopt;
  const ObjectInfo& info = members_.info(passed.number);
  ExplainedMiss miss{.object = info.name,
                     .verdict = static_cast<collided::Verdict>(found->touches),
                     .distance_m = found->clearance_m,
                     .error_m = found->error_m + end_error_m,
                     .on_ray = found->on_a,
                     .on_object = found->on_b,
                     .point_error_m = found->point_error_m + end_error_m,
                     .triangle = info.reported_triangle(found->b_triangle),
                     .box_met = passed.is_box_met,
                     .why_left_out = why_left_out(info, ask_)};
  if (found->touches == Decision::yes) {
    // The exact ray test found no hit: the two are apart by no more than the segment's error.
    miss.verdict = is_any_open_ ? collided::Verdict::undecided : collided::Verdict::miss;
    miss.distance_m = 0;
    miss.error_m = placing_error_m(segment, kNoTriangle, object, kNoTriangle) + end_error_m;
  }
  miss.along_m = std::clamp((miss.on_ray - ray_.origin).dot(unit_), 0.0, ray_.length_m);
  if (miss.along_m + miss.point_error_m >= ray_.length_m) miss.where = WhereMissed::end;
  else if (miss.along_m <= miss.point_error_m) miss.where = WhereMissed::start;
  return miss;
}

}  // namespace collided::engine
