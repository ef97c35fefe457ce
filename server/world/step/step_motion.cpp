#include "server/world/step/step_motion.hpp"

#include <algorithm>

#include "server/geometry/placing_error.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/column.hpp"
#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

BodyMotion motion_between(const std::optional<Sphere>& lone_sphere, const Frame& before, const Frame& now,
                          const Vec3& pivot) {
  if (!lone_sphere) return {before, now, pivot};
  BodyMotion path{now, now};
  const Vec3& center = lone_sphere->center;
  path.from.position = place(before, center) - (place(now, center) - now.position);
  path.travel = path.to.position - path.from.position;
  return path;
}

MotionTimes motion_times(const ObjectRow& row, bool is_new, const Source* source) {
  const std::int64_t settled_ns = source != nullptr ? source->settled_of(row.said_before_ns) : row.posed_before_ns;
  const std::int64_t since_ns = std::max({row.posed_before_ns, row.born_ns, settled_ns});
  const std::int64_t to_ns = std::max(row.posed_ns, is_new || source == nullptr ? row.born_ns : settled_ns + 1);
  return {.from_ns = row.has_motion && since_ns < to_ns ? since_ns : to_ns, .to_ns = to_ns};
}

namespace {

/// How far the motions of a sphere's centre and of its frame's origin may differ, metres: the exact sweep subtracts
/// that of the origin.
double strayed_m(const ObjectRow& row, const BallMotion& ball) {
  const Vec3 of_origin = row.pose.position - row.pose_before.position;
  const double rounding_m = kRoundoff * (row.pose.position.lpNorm<1>() + row.pose_before.position.lpNorm<1>() +
                                         ball.start.lpNorm<1>() + ball.end.lpNorm<1>());
  return ((ball.end - ball.start - of_origin).norm() + 4 * rounding_m) * (1 + kBoundSlack);
}

}  // namespace

void StepMotion::begin_step(const Sources& sources, SeparationCache& apart) {
  const std::size_t count = rows_.row_count();
  resize_column(bounds_, count);
  resize_column(balls_, balls_.empty() ? 0 : count);
  resize_column(swept_, count);
  resize_column(open_, count);
  note_changed(widened_);
  for (const std::uint32_t slot : widened_) {
    if (slot < count && !rows_.has_moved(slot)) bounds_[slot] = rows_.bounds(slot);
  }
  widened_.assign(rows_.moved().begin(), rows_.moved().end());
  for (const std::uint32_t slot : rows_.moved()) {
    const std::optional<MovingSphere> path = sphere_motion(slot);
    const Aabb at_end = rows_.bounds(slot);
    take_motion(slot, path, at_end);
    set_ball(slot, path);
    count_motion(slot, apart);
    if (rows_.info(slot) == nullptr || rows_.is_new(slot)) history_.forget(slot);
    if (sources.need_common_time() && rows_.is_new(slot)) young_.push_back(slot);
    if (sources.need_common_time() && rows_.is_posed(slot) && rows_.info(slot) != nullptr)
      history_.add(slot, segment_of(rows_, slot, sources[rows_.source(slot)], at_end, bounds_[slot]));
  }
  if (sources.is_any_over_floor_again()) begin_anew(sources);
  for (const std::uint32_t slot : young_) open_[slot] = 1;
  for (const std::uint32_t slot : history_.travelling()) {
    open_[slot] = 1;
    if (!rows_.has_moved(slot)) widened_.push_back(slot);
    bounds_[slot].extend(history_.bounds(slot));
  }
  note_changed(widened_);
}

/// As many changes as objects cause the index to be rebuilt, so more need not be listed.
void StepMotion::note_changed(const std::vector<std::uint32_t>& slots) {
  if (changed_.size() < rows_.row_count()) changed_.insert(changed_.end(), slots.begin(), slots.end());
}

/// Sets the bounds of an object's motion, and whether it is swept.
void StepMotion::take_motion(std::uint32_t slot, const std::optional<MovingSphere>& path, const Aabb& at_end) {
  const ObjectRow& row = rows_[slot];
  swept_[slot] = 0;
  bounds_[slot] = at_end;
  if (path) bounds_[slot].extend(engine::bounds(Sphere{path->start, path->radius_m}));
  if (rows_.motion(slot) != Motion::moved || row.is_lone_sphere()) return;
  // If both rotations are equal, any rotation will do.
  const Frame now = row.has_rotation_before() ? Frame{.position = row.pose.position} : row.frame();
  const Frame before = row.frame_before(now);
  if (before.rotation != now.rotation) swept_[slot] = kMoves | kTurns;
  else if (before.position != now.position) swept_[slot] = kMoves;
  else return;
  bounds_[slot] = quick_bounds(*rows_.info(slot), before, now, at_end, row.reach_m);
}

/// Tests objects against all sources again if their source fell behind the floor.
void StepMotion::begin_anew(const Sources& sources) {
  for (std::uint32_t slot = 0; slot < rows_.size(); ++slot) {
    const std::uint32_t source = rows_.source(slot);
    if (source != Sources::kResting && sources.is_over_floor_again(sources[source])) young_.push_back(slot);
  }
}

void StepMotion::end_step(std::int64_t floor_ns) {
  for (const std::uint32_t slot : rows_.moved()) swept_[slot] = 0;
  for (const std::uint32_t slot : young_) open_[slot] = 0;
  for (const std::uint32_t slot : history_.travelling()) open_[slot] = 0;
  std::erase_if(young_,
                [&](std::uint32_t slot) { return rows_.info(slot) == nullptr || rows_[slot].born_ns <= floor_ns; });
  history_.forget_up_to(floor_ns);
}

namespace {

/// Same as bounds(info, path, reach_m) for a sphere with known bounds at the end.
Aabb bounds_of_way(const Sphere& sphere, const BodyMotion& path, const Aabb& at_end) {
  const Aabb at_begin = engine::bounds(place(path.from, sphere));
  Aabb all = grown(at_begin, placing_error_of(path.from, sphere));
  all.extend(at_end);
  return grown(all, 2 * path.error_m(sphere.center.norm() + sphere.radius_m));
}

}  // namespace

/// Same as segment_of(), up to slightly wider bounds, for a sphere around its frame's origin, from the bounds of its
/// motion.
void set_ball_way(const ObjectRow& row, const Aabb& all_along, MotionSegment& segment) {
  segment.to = row.frame();
  segment.from = {.rotation = segment.to.rotation, .position = placed_center(row.pose_before, Vec3::Zero())};
  const double farthest_m =
      segment.from.position.cwiseAbs().maxCoeff() + segment.to.position.cwiseAbs().maxCoeff() + row.lone_radius_m;
  // One more than bounds() adds, which covers the rounding of these sums.
  const Vec3 margin_m = Vec3::Constant(3 * kWayError * farthest_m);
  segment.bounds = {.low = all_along.low - margin_m, .high = all_along.high + margin_m};
}

MotionSegment segment_of(const ObjectRows& rows, std::uint32_t slot, const Source& source, const Aabb& at_end,
                         const Aabb& all_along) {
  const ObjectRow& row = rows[slot];
  const MotionTimes times = motion_times(row, rows.is_new(slot), &source);
  if (row.is_centred_sphere && rows.motion(slot) == Motion::moved && times.from_ns < times.to_ns) {
    MotionSegment segment;
    segment.from_ns = times.from_ns;
    segment.to_ns = times.to_ns;
    set_ball_way(row, all_along, segment);
    return segment;
  }
  MotionSegment segment{
      .from_ns = times.from_ns, .to_ns = times.to_ns, .from = row.frame_before(), .to = row.frame(), .bounds = at_end};
  if (!segment.is_jump()) {
    segment.pivot = rows.pivot(slot);
    const std::optional<Sphere> sphere = rows.lone_sphere(slot);
    const BodyMotion path = motion_between(sphere, segment.from, segment.to, segment.pivot);
    segment.from = path.from;
    segment.to = path.to;
    segment.bounds = sphere ? bounds_of_way(*sphere, path, at_end) : bounds(*rows.info(slot), path, row.reach_m);
  } else {
    segment.bounds.extend(bounds_of(*rows.info(slot), segment.from));
  }
  return segment;
}

std::optional<MovingSphere> StepMotion::sphere_motion(std::uint32_t slot) const {
  const ObjectRow& row = rows_[slot];
  if (!row.is_lone_sphere() || rows_.motion(slot) != Motion::moved) return std::nullopt;
  const Vec3 center = rows_.lone_sphere(slot)->center;
  return MovingSphere{.start = placed_center(row.pose_before, center),
                      .end = placed_center(row.pose, center),
                      .radius_m = row.lone_radius_m};
}

BodyMotion StepMotion::body_motion(std::uint32_t slot) const {
  const ObjectRow& row = rows_[slot];
  const Frame now = row.frame();
  return motion_between(rows_.lone_sphere(slot), rows_.motion(slot) == Motion::moved ? row.frame_before(now) : now, now,
                        rows_.pivot(slot));
}

double StepMotion::longest_displacement_m(std::uint32_t slot, double reach_m) const {
  if (rows_.motion(slot) != Motion::moved) return 0;
  return engine::longest_displacement_m(rows_[slot].frame_before(), rows_[slot].frame(), reach_m);
}

void StepMotion::set_ball(std::uint32_t slot, const std::optional<MovingSphere>& path) {
  const ObjectRow& row = rows_[slot];
  if (row.is_lone_sphere() && balls_.empty()) balls_.resize(rows_.row_count());
  if (balls_.empty()) return;
  BallMotion& ball = balls_[slot];
  ball.radius_m = row.lone_radius_m;
  if (!row.is_lone_sphere()) return;
  const Sphere sphere = *rows_.lone_sphere(slot);
  ball.end = path ? path->end : placed_center(row.pose, sphere.center);
  ball.start = path ? path->start : ball.end;
  if (row.is_centred_sphere) return;
  ball.radius_m += 2 * placing_error_m(row.frame(), sphere) + (path ? strayed_m(row, ball) : 0);
}

/// Records how far meshes move, for the separation cache; a placed triangle is off by a rounding at either end.
void StepMotion::count_motion(std::uint32_t slot, SeparationCache& apart) const {
  if (apart.size() == 0) return;  // a pair that is remembered later counts from then on
  const ObjectInfo* info = rows_.info(slot);
  if (info == nullptr || !is_bare_mesh(*info)) return;
  if (rows_.motion(slot) != Motion::moved) {
    apart.placed(slot);
    return;
  }
  const double reach_m = info->mesh->radius_m + 2 * rows_.pivot(slot).stableNorm();
  apart.moved(slot, longest_displacement_m(slot, reach_m) * (1 + kBoundSlack) +
                        placement_slack(rows_[slot].pose_before.position, 0, reach_m) +
                        placement_slack(rows_[slot].pose.position, 0, reach_m));
}

}  // namespace collided::engine
