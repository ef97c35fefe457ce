#include <cmath>
#include <optional>

#include "client/library/c/values.hpp"

namespace collided::c {
namespace {

std::vector<Vec3> points_of(const collided_part& part) {
  std::vector<Vec3> points;
  points.reserve(part.point_count);
  for (std::size_t i = 0; i < part.point_count; ++i) points.push_back(vector(part.points + 3 * i));
  return points;
}

MeshShape mesh_of(const collided_part& part) {
  MeshShape mesh{.vertices = points_of(part), .triangles = {}};
  mesh.triangles.reserve(part.triangle_count);
  for (std::size_t i = 0; i < part.triangle_count; ++i) {
    const std::uint32_t* const corners = part.triangles + 3 * i;
    mesh.triangles.push_back({corners[0], corners[1], corners[2]});
  }
  return mesh;
}

Result<ShapePart> height_field_of(const collided_part& part) {
  const double columns = part.numbers[0];
  if (!(columns >= 2 && columns <= 0x7fffffff && columns == std::floor(columns))) {
    return Error{ErrorCode::bad_input,
                 "a height field of " + std::to_string(columns) + " columns; a whole number from 2",
                 "nothing was sent"};
  }
  return ShapePart(HeightFieldShape{.columns = static_cast<std::uint32_t>(columns),
                                    .spacing_x_m = part.numbers[1],
                                    .spacing_y_m = part.numbers[2],
                                    .heights_m = {part.points, part.points + part.point_count}});
}

Result<ShapePart> part_of(const collided_part& part) {
  if ((part.point_count > 0 && !part.points) || (part.triangle_count > 0 && !part.triangles)) {
    return missing("an array of a part");
  }
  const double* const n = part.numbers;
  switch (part.kind) {
    case COLLIDED_SPHERE: return ShapePart(SphereShape{.radius_m = n[3], .center = vector(n)});
    case COLLIDED_BOX:
      return ShapePart(BoxShape{.half_m = vector(n), .center = vector(n + 3), .rotation = rotation(n + 6)});
    case COLLIDED_CAPSULE: return ShapePart(CapsuleShape{.a = vector(n), .b = vector(n + 3), .radius_m = n[6]});
    case COLLIDED_CYLINDER: return ShapePart(CylinderShape{.a = vector(n), .b = vector(n + 3), .radius_m = n[6]});
    case COLLIDED_CONE: return ShapePart(ConeShape{.apex = vector(n), .base = vector(n + 3), .radius_m = n[6]});
    case COLLIDED_ELLIPSOID:
      return ShapePart(EllipsoidShape{.half_m = vector(n), .center = vector(n + 3), .rotation = rotation(n + 6)});
    case COLLIDED_HALF_SPACE: return ShapePart(HalfSpaceShape{.normal = vector(n), .point = vector(n + 3)});
    case COLLIDED_HULL: return ShapePart(HullShape{.points = points_of(part)});
    case COLLIDED_MESH: return ShapePart(mesh_of(part));
    case COLLIDED_HEIGHT_FIELD: return height_field_of(part);
    case COLLIDED_CLOUD: return ShapePart(CloudShape{.points = points_of(part), .radius_m = n[0]});
    case COLLIDED_POLYLINE: return ShapePart(PolylineShape{.points = points_of(part), .radius_m = n[0]});
    default: break;
  }
  return unknown_kind("part", part.kind, 11);
}

}  // namespace

Result<Shape> shape_of(const collided_part* parts, std::size_t part_count) {
  if (part_count > 0 && !parts) return missing("parts");
  // The parts are spaced by the struct's size in the caller's header.
  const auto* bytes = reinterpret_cast<const unsigned char*>(parts);
  Shape made;
  for (std::size_t i = 0; i < part_count; ++i, bytes += parts->size) {
    Result<ShapePart> part = part_of(taken(reinterpret_cast<const collided_part*>(bytes)));
    if (!part) return part.error();
    made.push_back(std::move(*part));
  }
  return made;
}

}  // namespace collided::c
