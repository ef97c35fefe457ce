#pragma once

#include <cstdint>
#include <optional>

#include "server/exact_phase/time_of_contact.hpp"
#include "server/world/swept_object.hpp"
#include "server/world/touch.hpp"

namespace collided {

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

/// What decides whether an object moves fast for its size.
struct MoverSize {
  double reach_m = 0;  // no point is farther from the frame's origin
  /// Between parallel planes nearer than this no part of the object fits, or little nearer: exact for balls, boxes,
  /// capsules, cylinders and ellipsoids, less for cones and hulls, and for a mesh the least along its axes and the
  /// normals of some of its triangles (a ring is as wide as its outside).
  double least_width_m = 0;
};

MoverSize size_of(const ObjectInfo& info);

/// How far a point within reach_m goes at most between the two frames.
double longest_way_m(const Frame& from, const Frame& to, double reach_m);

/// Contains the object at every time.
Aabb bounds(const ObjectInfo& info, const BodyWay& way, double reach_m);

}  // namespace collided
