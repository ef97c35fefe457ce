#pragma once

#include <memory>
#include <variant>

#include "server/geometry/vector.hpp"

namespace collided::engine {

struct TriangleMesh;

/// The closed point sets of the exact phase, each exactly the set that its doubles describe. All are convex, and all
/// are solid except the triangle, which is flat; all except the half-space are bounded. Zero sizes are allowed: points
/// and segments.

struct Sphere {
  Vec3 center;
  double radius_m = 0;
};

/// {center + sum_i u_i * half_m[i] * axes.col(i) : |u_i| <= 1}. The axes are used as given: after a rotation in double
/// they are orthonormal only up to rounding, and decisions are exact for that parallelepiped.
struct Box {
  Vec3 center;
  Mat3 axes = Mat3::Identity();
  Vec3 half_m = Vec3::Zero();
};

/// All points within radius_m of the segment a b.
struct Capsule {
  Vec3 a;
  Vec3 b;
  double radius_m = 0;
};

/// All points within radius_m of the line a b and between the planes perpendicular to it at a and b; a != b.
struct Cylinder {
  Vec3 a;
  Vec3 b;
  double radius_m = 0;
};

/// The hull of the apex and the disc of radius_m around the base, perpendicular to the segment between them; apex !=
/// base.
struct Cone {
  Vec3 apex;
  Vec3 base;
  double radius_m = 0;
};

/// {center + sum_i u_i * half_m[i] * axes.col(i) : |u| <= 1}; the axes are used as given, like those of a box.
struct Ellipsoid {
  Vec3 center;
  Mat3 axes = Mat3::Identity();
  Vec3 half_m = Vec3::Zero();
};

/// The hull of a mesh's vertices, each rotated, translated and rounded separately.
struct Hull {
  std::shared_ptr<const TriangleMesh> mesh;  // its faces: closed, oriented outward
  Mat3 rotation = Mat3::Identity();
  Vec3 position = Vec3::Zero();
};

/// {x : normal . (x - point) <= 0}. The normal points out of the ground; any length but zero.
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
