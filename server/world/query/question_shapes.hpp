#pragma once

#include "server/geometry/pose.hpp"
#include "server/geometry/ray.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

// Turns a question's numbers (Query.numbers in collided.idl, already validated) into the shape that they describe.

inline Vec3 point_of(const double* n) { return {n[0], n[1], n[2]}; }

inline Ray ray_of(const double* n) {
  return {.origin = point_of(n), .direction = {n[3], n[4], n[5]}, .length_m = n[6]};
}

inline Sphere sphere_of(const double* n) { return {.center = point_of(n), .radius_m = n[3]}; }

inline Box box_of(const double* n) {
  const Pose pose{.position = point_of(n), .rotation = Quat(n[6], n[7], n[8], n[9])};
  return {.center = pose.position, .axes = frame_of(pose).rotation, .half_m = {n[3], n[4], n[5]}};
}

}  // namespace collided::engine
