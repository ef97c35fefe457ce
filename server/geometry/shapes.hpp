#pragma once

#include <variant>

#include "server/geometry/vector.hpp"

namespace collided {

/// The closed point sets that the exact phase decides about, each the exact set that its doubles describe.
/// Sphere, box and capsule are solid; a triangle is flat. Zero sizes are legal: points and segments.

struct Sphere {
  Vec3 center;
  double radius_m = 0;
};

/// {center + sum_i u_i * half_m[i] * axes.col(i) : |u_i| <= 1}. The axes are taken as given: after a rotation in
/// double they are orthonormal only to rounding, and decisions are exact for that parallelepiped.
struct Box {
  Vec3 center;
  Mat3 axes = Mat3::Identity();
  Vec3 half_m = Vec3::Zero();
};

/// Every point within radius_m of the segment a b.
struct Capsule {
  Vec3 a;
  Vec3 b;
  double radius_m = 0;
};

struct Triangle {
  Vec3 a;
  Vec3 b;
  Vec3 c;
};

using Primitive = std::variant<Sphere, Box, Capsule>;

}  // namespace collided
