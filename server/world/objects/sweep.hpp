#pragma once

#include <cstdint>
#include <optional>

#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/swept_object.hpp"

namespace collided::engine {

/// The sphere that an object is, where it is nothing else: such objects are always swept between their poses.
std::optional<Sphere> lone_sphere(const ObjectInfo& info);

/// A sphere on its way, and the earliest contact found so far.
struct SphereSweep {
  MovingSphere mover;
  double width = 0;
  SweptTouch found = {};  // a is the sphere
};

/// Contains the sphere at every time.
Aabb bounds(const MovingSphere& mover);

void sweep_part(SphereSweep& sweep, const Triangle& part, std::uint32_t triangle);
void sweep_object(SphereSweep& sweep, const Placed& other, WalkCost& cost);

/// The same contact seen from the other side.
SweptTouch turned_round(SweptTouch touch);

/// No point of the object is farther from its frame's origin, metres.
double reach_of(const ObjectInfo& info);

/// The angle between the two frames, or somewhat more.
double most_turn_rad(const Frame& from, const Frame& to);

/// How far a point within reach_m goes at most between the two frames.
double longest_displacement_m(const Frame& from, const Frame& to, double reach_m);

/// Contains the object at every time.
Aabb bounds(const ObjectInfo& info, const BodyMotion& motion, double reach_m);
/// So does this, of the way between two frames, from its bounds at the last: somewhat wider, without the way's arc cosine.
Aabb quick_bounds(const ObjectInfo& info, const Frame& from, const Frame& to, const Aabb& bounds_at_end, double reach_m);

}  // namespace collided::engine
