#include "server/world/objects/sweep.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/geometry/common_origin.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

/// mover, part  as seen from the origin; sweep.found is in world coordinates
template <class Part>
void sweep_any(SphereSweep& sweep, const Vec3& origin, const MovingSphere& mover, const Part& part,
               std::uint32_t triangle) {
  SweptContact& found = sweep.found;
  TimeBracket bracket;
  const ExactResult verdict = first_contact(mover, part, sweep.width, bracket);
  ++found.exact_tests;
  if (verdict.decision == Decision::undecided) found.undecided = true;
  if (!verdict.yes()) return;
  if (!found.take(bracket, kNoTriangle, triangle) || !sweep.contacts) return;
  const Vec3 center = mover.start + bracket.high * (mover.end - mover.start);
  found.contact = contact(Sphere{.center = center, .radius_m = mover.radius_m}, part);
  found.contact.point = back_from(origin, found.contact.point);
}

}  // namespace

const Box* lone_box(const ObjectInfo& info) {
  return info.mesh || info.primitives.size() != 1 ? nullptr : std::get_if<Box>(&info.primitives.front());
}

std::optional<Sphere> lone_sphere(const ObjectInfo& info) {
  if (info.mesh || info.primitives.size() != 1) return std::nullopt;
  const Sphere* sphere = std::get_if<Sphere>(&info.primitives.front());
  return sphere != nullptr ? std::optional(*sphere) : std::nullopt;
}

Aabb bounds(const MovingSphere& mover) {
  return bounds(Capsule{.a = mover.start, .b = mover.end, .radius_m = mover.radius_m});
}

void sweep_part(SphereSweep& sweep, const Triangle& part, std::uint32_t triangle) {
  const Vec3 origin = common_origin(part.a, {part.b, part.c, sweep.mover.start, sweep.mover.end});
  sweep_any(sweep, origin, seen_from(origin, sweep.mover), seen_from(origin, part), triangle);
}

void sweep_object(SphereSweep& sweep, const Placed& other, WalkCost& cost) {
  const Vec3 origin = common_origin(other.frame.position, {sweep.mover.start, sweep.mover.end});
  const MovingSphere mover = seen_from(origin, sweep.mover);
  const Frame frame = seen_from(origin, other.frame);
  visit_primitives_near(*other.info, frame, bounds(mover), cost, [&](const Primitive& primitive) {
    std::visit([&](const auto& part) { sweep_any(sweep, origin, mover, place(frame, part), kNoTriangle); }, primitive);
    return true;
  });
  if (!other.info->mesh) return;
  const IndexedMesh& mesh = *other.info->mesh;
  const auto candidate = [&](std::uint32_t triangle) {
    sweep_any(sweep, origin, mover, place(frame, mesh.mesh->triangle(triangle)), triangle);
    return true;
  };
  mesh.tree.walk_box(seen_from(frame, bounds(mover), mesh.radius_m), candidate, cost);
}

SweptContact turned_round(SweptContact touch) {
  std::swap(touch.a_triangle, touch.b_triangle);
  touch.contact.normal = -touch.contact.normal;
  return touch;
}

ContactSearch turned_round(ContactSearch touch) {
  std::swap(touch.a_triangle, touch.b_triangle);
  touch.contact.normal = -touch.contact.normal;
  return touch;
}

double reach_of(const ObjectInfo& info) {
  double reach_m = info.mesh && !info.mesh->mesh->vertices.empty() ? info.mesh->radius_m : 0;
  const BodyMotion nowhere;
  for (const Primitive& primitive : info.primitives) {
    // A half-space never moves.
    if (std::holds_alternative<HalfSpace>(primitive)) continue;
    reach_m = std::max(reach_m, PartMotion(part_of(primitive), nowhere).reach_m);
  }
  return reach_m;
}

/// Rotating by an angle t changes the matrix by sqrt(8) sin(t / 2), and t is at most pi / sqrt(8) times that.
double most_turn_rad(const Frame& from, const Frame& to) { return 1.1108 * (to.rotation - from.rotation).norm(); }

double longest_displacement_m(const Frame& from, const Frame& to, double reach_m) {
  return (to.position - from.position).norm() + most_turn_rad(from, to) * reach_m;
}

/// An arc leaves its chord by at most an eighth of reach * angle^2.
Aabb bounds(const ObjectInfo& info, const BodyMotion& motion, double reach_m) {
  Aabb all = bounds_of(info, motion.from);
  all.extend(bounds_of(info, motion.to));
  return grown(all, motion.lever_m(reach_m) * motion.turn_rad * motion.turn_rad / 8 + 2 * motion.error_m(reach_m));
}

namespace {

/// Up to this rotation the quick bounds are hardly larger, and cost a third.
constexpr double kSlightTurn_rad = 0x1p-5;

}  // namespace

Aabb quick_bounds(const ObjectInfo& info, const Frame& from, const Frame& to, const Aabb& bounds_at_end,
                  double reach_m) {
  const double turn_rad = most_turn_rad(from, to);
  const double error_m =
      kWayError * (from.position.cwiseAbs().maxCoeff() + to.position.cwiseAbs().maxCoeff() + reach_m);
  if (turn_rad <= kSlightTurn_rad) {
    // The rotation moves no point farther than this, so the bounds at the end are valid throughout.
    Aabb all = bounds_at_end;
    const Vec3 back = from.position - to.position;
    all.extend(Aabb{.low = bounds_at_end.low + back, .high = bounds_at_end.high + back});
    return grown(all, reach_m * turn_rad + 2 * error_m);
  }
  Aabb all = bounds_of(info, from);
  all.extend(bounds_at_end);
  return grown(all, reach_m * turn_rad * turn_rad / 8 + 2 * error_m);
}

StraightWay::StraightWay(const MovingSphere& sphere)
    : start_(sphere.start),
      travel_(sphere.end - sphere.start),
      around_{.low = Vec3::Constant(-sphere.radius_m), .high = Vec3::Constant(sphere.radius_m)} {
  around_ = grown(around_, kWayError * (sphere.start.cwiseAbs().maxCoeff() + sphere.end.cwiseAbs().maxCoeff()));
}

StraightWay::StraightWay(const BodyMotion& motion, const Aabb& bounds_at_end, double reach_m) {
  const bool turns = motion.from.rotation != motion.to.rotation;
  const Vec3 pivot = turns ? motion.pivot : Vec3::Zero();
  const Vec3 end = turns ? place(motion.to, pivot) : motion.to.position;
  start_ = turns ? place(motion.from, pivot) : motion.from.position;
  travel_ = end - start_;
  if (turns) around_ = {.low = Vec3::Constant(-reach_m), .high = Vec3::Constant(reach_m)};
  else around_ = {.low = bounds_at_end.low - end, .high = bounds_at_end.high - end};
  const double farthest_m = motion.from.position.cwiseAbs().maxCoeff() + motion.to.position.cwiseAbs().maxCoeff();
  around_ = grown(around_, 2 * kWayError * (farthest_m + 2 * reach_m) + 2 * motion.error_m(reach_m));
}

Aabb StraightWay::between(double begin, double end) const {
  const Vec3 first = start_ + begin * travel_;
  const Vec3 last = start_ + end * travel_;
  return {.low = first.cwiseMin(last) + around_.low, .high = first.cwiseMax(last) + around_.high};
}

}  // namespace collided::engine
