#pragma once

#include <memory>
#include <variant>

#include "server/geometry/vector.hpp"

namespace collided::engine {

struct TriangleMesh;

/// The closed point sets that the exact phase decides about, each the exact set that its doubles describe.
/// All are convex, and solid but for the triangle, which is flat; all but the half-space are bounded. Zero sizes are
/// legal: points and segments.

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

/// Every point between the planes across the segment a b at its ends and within radius_m of its line; a != b.
struct Cylinder {
  Vec3 a;
  Vec3 b;
  double radius_m = 0;
};

/// The hull of the apex and the disc of radius_m about the base, across the segment between them; apex != base.
struct Cone {
  Vec3 apex;
  Vec3 base;
  double radius_m = 0;
};

/// {center + sum_i u_i * half_m[i] * axes.col(i) : |u| <= 1}, the axes as given, like those of a box.
struct Ellipsoid {
  Vec3 center;
  Mat3 axes = Mat3::Identity();
  Vec3 half_m = Vec3::Zero();
};

/// The hull of a mesh's vertices, each rotated, moved and rounded by itself.
struct Hull {
  std::shared_ptr<const TriangleMesh> mesh;  // its faces: closed, outward
  Mat3 rotation = Mat3::Identity();
  Vec3 position = Vec3::Zero();
};

/// {x : normal . (x - point) <= 0}. The normal points out of the ground and need not be of unit length, but not be zero.
struct HalfSpace {
  Vec3 point;
  Vec3 normal;
};

struct Triangle {
  Vec3 a;
  Vec3 b;
  Vec3 c;
};

using Primitive = std::variant<Sphere, Box, Capsule, Cylinder, Cone, Ellipsoid, Hull, HalfSpace>;

}  // namespace collided::engine
