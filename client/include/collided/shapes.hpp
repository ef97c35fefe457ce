#pragma once

#include <array>
#include <cstdint>
#include <variant>
#include <vector>

#include <collided/geometry.hpp>

/// Shapes of objects. Everything is in metres and in the object's own frame; all numbers are finite. A radius or a half
/// size may be 0 unless stated otherwise. Calls that take a shape check it and return bad_input.
#pragma GCC visibility push(default)

namespace collided {

struct SphereShape {
  double radius_m = 0;
  Vec3 center = Vec3::Zero();
};
struct BoxShape {
  Vec3 half_m = Vec3::Zero();  // half of each edge, along the box's own axes
  Vec3 center = Vec3::Zero();
  Quat rotation = Quat::Identity();  // from the box's axes to the object's frame
};
/// All points within radius_m of the segment from a to b.
struct CapsuleShape {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::Zero();
  double radius_m = 0;
};
/// All points within radius_m of the segment from a to b, cut flat by the planes through a and b across it; a != b.
struct CylinderShape {
  Vec3 a = Vec3::Zero();
  Vec3 b = Vec3::UnitZ();
  double radius_m = 0;
};
/// The base is a disc of radius_m about `base`, perpendicular to the axis from the apex; apex != base.
struct ConeShape {
  Vec3 apex = Vec3::UnitZ();
  Vec3 base = Vec3::Zero();
  double radius_m = 0;
};
struct EllipsoidShape {
  Vec3 half_m = Vec3::Ones();  // half axes, each above 0
  Vec3 center = Vec3::Zero();
  Quat rotation = Quat::Identity();  // from the ellipsoid's axes to the object's frame
};
/// The convex hull of 4 to 4,096 points that are not all in one plane.
struct HullShape {
  std::vector<Vec3> points;
};
/// A surface of triangles; its interior is not solid.
struct MeshShape {
  std::vector<Vec3> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;  // three vertex indices each; at least one triangle
};

/// All points behind a plane: normal . (x - point) <= 0. It must be the only part of its object, and the object must
/// not move.
struct HalfSpaceShape {
  Vec3 normal = Vec3::UnitZ();  // any length from 1e-30 to 1e30
  Vec3 point = Vec3::Zero();
};
/// A surface over a grid in the x-y plane that begins at the origin, with two triangles per cell. It counts as a mesh.
struct HeightFieldShape {
  std::uint32_t columns = 0;      // grid points along x, at least 2
  double spacing_x_m = 1;         // from one column to the next, above 0
  double spacing_y_m = 1;         // from one row to the next, above 0
  std::vector<double> heights_m;  // row by row, each along x; whole rows, at least 2 of them
};
/// A ball about each of at least 1 point. The server builds an index over them.
struct CloudShape {
  std::vector<Vec3> points;
  double radius_m = 0;
};
/// A capsule from each of at least 2 points to the next. The server builds an index over them.
struct PolylineShape {
  std::vector<Vec3> points;
  double radius_m = 0;
};

/// Cells of a regular grid aligned with the object's axes. Cell (i, j, k) extends from (low + (i, j, k)) * cell_m by
/// one cell along each axis. Occupied cells that fill a box are merged: distances and hits are those of the cells,
/// depths and exit points of rays those of the boxes.
struct VoxelShape {
  double cell_m = 0;                     // above 0, of at most 24 significant bits: then all corners are exact
  std::array<std::int32_t, 3> low{};     // within 2^26
  std::array<std::uint32_t, 3> size{};   // cells along each axis, 1 to 256
  std::vector<std::uint8_t> occupied{};  // bit i + size[0] * (j + size[1] * k), low bits of a byte first
};

/// One part of a shape.
using ShapePart = std::variant<SphereShape, BoxShape, CapsuleShape, MeshShape, CylinderShape, ConeShape, EllipsoidShape,
                               HullShape, HalfSpaceShape, HeightFieldShape, CloudShape, PolylineShape, VoxelShape>;
/// One or more parts that move as one. At most one of them is a mesh or a height field.
using Shape = std::vector<ShapePart>;

}  // namespace collided

#pragma GCC visibility pop
