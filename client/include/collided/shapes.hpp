#pragma once

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include <collided/geometry.hpp>

/// What objects are made of.
#pragma GCC visibility push(default)

namespace collided {

struct SphereShape {
  double radius_m = 0;
  Vec3 center = Vec3::Zero();
};
struct BoxShape {
  Vec3 half_m = Vec3::Zero();
  Vec3 center = Vec3::Zero();
  Quat rotation = Quat::Identity();
};
struct CapsuleShape {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  double radius_m = 0;
};
/// Between the planes across a b at its ends; a != b.
struct CylinderShape {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::UnitZ();
  double radius_m = 0;
};
/// The radius is that of the base, across the way from the apex; apex != base.
struct ConeShape {
  Vec3 apex = Vec3::UnitZ();
  Vec3 base = Vec3::Zero();
  double radius_m = 0;
};
struct EllipsoidShape {
  Vec3 half_m = Vec3::Ones();  // all above 0
  Vec3 center = Vec3::Zero();
  Quat rotation = Quat::Identity();
};
/// The convex hull of up to 4,096 points that are not all in one plane.
struct HullShape {
  std::vector<Vec3> points;
};
struct MeshShape {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// Everything behind a plane: normal . (x - point) <= 0. Alone in its shape, of an object that does not move.
struct HalfSpaceShape {
  Vec3 normal = Vec3::UnitZ();  // any length from 1e-30 to 1e30
  Vec3 point = Vec3::Zero();
};
/// A surface over a grid, row after row of heights along x from the origin on; two triangles a cell. Counts as a mesh.
struct HeightFieldShape {
  std::uint32_t columns = 0;
  double spacing_x_m = 1;
  double spacing_y_m = 1;
  std::vector<double> heights_m;  // whole rows, at least 2 of 2
};
/// Balls about points, with an index of its own.
struct CloudShape {
  std::vector<Vec3> points;
  double radius_m = 0;
};
/// Capsules from each point to the next, at least 2 points; with an index of its own.
struct PolylineShape {
  std::vector<Vec3> points;
  double radius_m = 0;
};

/// One part, or several that move as one. At most one of them a mesh or height field.
using ShapePart = std::variant<SphereShape, BoxShape, CapsuleShape, MeshShape, CylinderShape, ConeShape, EllipsoidShape,
                               HullShape, HalfSpaceShape, HeightFieldShape, CloudShape, PolylineShape>;
using Shape = std::vector<ShapePart>;

}  // namespace collided

#pragma GCC visibility pop
