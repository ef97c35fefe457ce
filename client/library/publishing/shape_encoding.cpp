#include "client/library/publishing/shape_encoding.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "client/library/asking/question_encoding.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/scene_generated.h"
#include "idl/topics.hpp"

namespace collided::client {
namespace {

// A definition is one message; its other fields take far less than this.
constexpr std::size_t kHeaderRoomBytes = 16 * 1024;
constexpr std::size_t kMaxShapeBytes = wire_contract::kMaxMessageBytes - kHeaderRoomBytes;

format::Vec3 packed(const Vec3& value) { return {value.x(), value.y(), value.z()}; }
format::Quat packed(const Quat& value) { return {value.w(), value.x(), value.y(), value.z()}; }

format::Mat3 packed(const Eigen::Matrix3d& value) {
  return {packed(Vec3(value.col(0))), packed(Vec3(value.col(1))), packed(Vec3(value.col(2)))};
}

std::optional<std::string> part_fault(const SphereShape& sphere) {
  auto found = finite_fault(sphere.center, "center");
  return found ? found : size_fault(sphere.radius_m, "radius");
}

std::optional<std::string> part_fault(const BoxShape& box) {
  return fault(BoxQuestion{box.center, box.half_m, box.rotation});
}

std::optional<std::string> part_fault(const CapsuleShape& capsule) {
  if (auto found = finite_fault(capsule.a, "end a")) { return found; }
  auto found = finite_fault(capsule.b, "end b");
  return found ? found : size_fault(capsule.radius_m, "radius");
}

std::optional<std::string> axis_fault(const Vec3& a, const Vec3& b, double radius_m) {
  if (auto found = finite_fault(a, "one end")) { return found; }
  if (auto found = finite_fault(b, "the other end")) { return found; }
  if (a == b) { return "both ends of its axis are the same point"; }
  return size_fault(radius_m, "radius");
}

std::optional<std::string> part_fault(const CylinderShape& cylinder) {
  return axis_fault(cylinder.a, cylinder.b, cylinder.radius_m);
}

std::optional<std::string> part_fault(const ConeShape& cone) { return axis_fault(cone.apex, cone.base, cone.radius_m); }

std::optional<std::string> part_fault(const EllipsoidShape& ellipsoid) {
  if (!(ellipsoid.half_m.array() > 0).all()) { return "half sizes must be above 0"; }
  return fault(BoxQuestion{ellipsoid.center, ellipsoid.half_m, ellipsoid.rotation});
}

std::optional<std::string> part_fault(const HullShape& hull) {
  if (hull.points.size() < 4) {
    return "a hull of " + std::to_string(hull.points.size()) + " points; at least 4 are needed";
  }
  for (const Vec3& point : hull.points) {
    if (auto found = finite_fault(point, "point")) { return found; }
  }
  return std::nullopt;
}

std::optional<std::string> part_fault(const MeshShape& mesh) {
  if (mesh.triangles.empty()) { return "a mesh without triangles"; }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (auto found = finite_fault(mesh.vertices[i], "vertex")) {
      return *found + " (vertex " + std::to_string(i) + ')';
    }
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t largest = *std::max_element(mesh.triangles[i].begin(), mesh.triangles[i].end());
    if (largest >= mesh.vertices.size()) {
      return "triangle " + std::to_string(i) + " names vertex " + std::to_string(largest) + " of " +
             std::to_string(mesh.vertices.size());
    }
  }
  return std::nullopt;
}

std::optional<std::string> part_fault(const HalfSpaceShape& half_space) {
  if (auto found = finite_fault(half_space.point, "point")) { return found; }
  if (auto found = finite_fault(half_space.normal, "normal")) { return found; }
  return half_space.normal.isZero(0) ? std::optional<std::string>("its normal is zero") : std::nullopt;
}

std::optional<std::string> part_fault(const HeightFieldShape& field) {
  if (field.columns < 2 || field.heights_m.size() < 2 * std::size_t{field.columns} ||
      field.heights_m.size() % field.columns != 0) {
    return "a height field of " + std::to_string(field.heights_m.size()) + " heights in " +
           std::to_string(field.columns) + " columns; whole rows are needed, at least 2 of 2";
  }
  if (!(field.spacing_x_m > 0 && field.spacing_y_m > 0 && std::isfinite(field.spacing_x_m + field.spacing_y_m))) {
    return "the spacings of a height field must be finite and above 0";
  }
  for (std::size_t i = 0; i < field.heights_m.size(); ++i) {
    if (!std::isfinite(field.heights_m[i])) { return "height " + std::to_string(i) + " is not finite"; }
  }
  return std::nullopt;
}

std::optional<std::string> points_fault(const std::vector<Vec3>& points, double radius_m, std::size_t least) {
  if (points.size() < least) {
    return std::to_string(points.size()) + " points; at least " + std::to_string(least) + " are needed";
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (auto found = finite_fault(points[i], "point")) { return *found + " (point " + std::to_string(i) + ')'; }
  }
  return size_fault(radius_m, "radius");
}

std::optional<std::string> part_fault(const CloudShape& cloud) { return points_fault(cloud.points, cloud.radius_m, 1); }
std::optional<std::string> part_fault(const PolylineShape& line) { return points_fault(line.points, line.radius_m, 2); }

std::optional<std::string> part_fault(const VoxelShape& voxels) {
  std::uint64_t cells = 1;
  for (const std::uint32_t size : voxels.size) {
    if (size < 1 || size > 256) { return std::to_string(size) + " cells along an axis; allowed 1 to 256"; }
    cells *= size;
  }
  if (!(voxels.cell_m > 0 && std::isfinite(voxels.cell_m))) { return "cells of " + words(voxels.cell_m) + " m"; }
  if (voxels.occupied.size() != (cells + 7) / 8) {
    return std::to_string(voxels.occupied.size()) + " bytes for " + std::to_string(cells) + " cells; needed are " +
           std::to_string((cells + 7) / 8);
  }
  return std::nullopt;
}

struct EncodedParts {
  std::vector<format::Sphere> spheres;
  std::vector<format::Box> boxes;
  std::vector<format::Capsule> capsules;
  std::vector<format::Cylinder> cylinders;
  std::vector<format::Cone> cones;
  std::vector<format::Ellipsoid> ellipsoids;
  std::vector<const HullShape*> hulls;
  std::vector<format::HalfSpace> half_spaces;
  std::vector<const CloudShape*> clouds;
  std::vector<const PolylineShape*> polylines;
  std::vector<const VoxelShape*> voxels;
  const HeightFieldShape* height_field = nullptr;
  const MeshShape* mesh = nullptr;

  void add(const SphereShape& sphere) { spheres.emplace_back(packed(sphere.center), sphere.radius_m); }
  void add(const BoxShape& box) { boxes.emplace_back(packed(box.center), packed(box.rotation), packed(box.half_m)); }
  void add(const CapsuleShape& capsule) {
    capsules.emplace_back(packed(capsule.a), packed(capsule.b), capsule.radius_m);
  }
  void add(const CylinderShape& c) { cylinders.emplace_back(packed(c.a), packed(c.b), c.radius_m); }
  void add(const ConeShape& c) { cones.emplace_back(packed(c.apex), packed(c.base), c.radius_m); }
  void add(const EllipsoidShape& e) {
    ellipsoids.emplace_back(packed(e.center), packed(e.rotation.toRotationMatrix()), packed(e.half_m));
  }
  void add(const HullShape& hull) { hulls.push_back(&hull); }
  void add(const MeshShape& one) { mesh = &one; }
  void add(const HalfSpaceShape& h) { half_spaces.emplace_back(packed(h.point), packed(h.normal)); }
  void add(const HeightFieldShape& one) { height_field = &one; }
  void add(const CloudShape& cloud) { clouds.push_back(&cloud); }
  void add(const PolylineShape& line) { polylines.push_back(&line); }
  void add(const VoxelShape& one) { voxels.push_back(&one); }
  bool has_surface() const { return mesh != nullptr || height_field != nullptr; }
};

std::vector<double> coordinates_of(const std::vector<Vec3>& points) {
  std::vector<double> coordinates;
  coordinates.reserve(points.size() * 3);
  for (const Vec3& point : points) { coordinates.insert(coordinates.end(), point.data(), point.data() + 3); }
  return coordinates;
}

flatbuffers::Offset<format::Mesh> build_mesh(flatbuffers::FlatBufferBuilder& builder, const MeshShape& mesh) {
  const std::vector<double> coordinates = coordinates_of(mesh.vertices);
  std::vector<std::uint32_t> corners;
  corners.reserve(mesh.triangles.size() * 3);
  for (const auto& triangle : mesh.triangles) { corners.insert(corners.end(), triangle.begin(), triangle.end()); }
  return format::CreateMeshDirect(builder, &coordinates, &corners);
}

/// The tables of clouds or polylines.
template <class Shape>
flatbuffers::Offset<flatbuffers::Vector<flatbuffers::Offset<format::Points>>> build_points(
    flatbuffers::FlatBufferBuilder& builder, const std::vector<const Shape*>& shapes) {
  std::vector<flatbuffers::Offset<format::Points>> tables;
  for (const Shape* shape : shapes) {
    const std::vector<double> coordinates = coordinates_of(shape->points);
    tables.push_back(format::CreatePointsDirect(builder, &coordinates, shape->radius_m));
  }
  return tables.empty() ? 0 : builder.CreateVector(tables);
}

flatbuffers::Offset<flatbuffers::Vector<flatbuffers::Offset<format::Voxels>>> build_voxels(
    flatbuffers::FlatBufferBuilder& builder, const std::vector<const VoxelShape*>& shapes) {
  std::vector<flatbuffers::Offset<format::Voxels>> tables;
  for (const VoxelShape* one : shapes) {
    tables.push_back(format::CreateVoxelsDirect(builder, one->cell_m, one->low[0], one->low[1], one->low[2],
                                                one->size[0], one->size[1], one->size[2], &one->occupied));
  }
  return tables.empty() ? 0 : builder.CreateVector(tables);
}

flatbuffers::Offset<format::HeightField> build_field(flatbuffers::FlatBufferBuilder& builder,
                                                     const HeightFieldShape* field) {
  if (field == nullptr) { return 0; }
  return format::CreateHeightFieldDirect(builder, field->columns, field->spacing_x_m, field->spacing_y_m,
                                         &field->heights_m);
}

std::vector<std::uint8_t> build(const EncodedParts& parts, const Vec3& scale, SaidSolid solid, bool is_unknown) {
  flatbuffers::FlatBufferBuilder builder;
  const auto spheres = parts.spheres.empty() ? 0 : builder.CreateVectorOfStructs(parts.spheres);
  const auto boxes = parts.boxes.empty() ? 0 : builder.CreateVectorOfStructs(parts.boxes);
  const auto capsules = parts.capsules.empty() ? 0 : builder.CreateVectorOfStructs(parts.capsules);
  const auto mesh = parts.mesh == nullptr ? 0 : build_mesh(builder, *parts.mesh);
  const auto cylinders = parts.cylinders.empty() ? 0 : builder.CreateVectorOfStructs(parts.cylinders);
  const auto cones = parts.cones.empty() ? 0 : builder.CreateVectorOfStructs(parts.cones);
  const auto ellipsoids = parts.ellipsoids.empty() ? 0 : builder.CreateVectorOfStructs(parts.ellipsoids);
  std::vector<flatbuffers::Offset<format::Mesh>> hull_tables;
  for (const HullShape* hull : parts.hulls) {
    const std::vector<double> coordinates = coordinates_of(hull->points);
    const std::vector<std::uint32_t> no_corners;
    hull_tables.push_back(format::CreateMeshDirect(builder, &coordinates, &no_corners));
  }
  const auto hulls = hull_tables.empty() ? 0 : builder.CreateVector(hull_tables);
  const auto half_spaces = parts.half_spaces.empty() ? 0 : builder.CreateVectorOfStructs(parts.half_spaces);
  const auto field = build_field(builder, parts.height_field);
  const auto clouds = build_points(builder, parts.clouds);
  const auto polylines = build_points(builder, parts.polylines);
  const auto voxels = build_voxels(builder, parts.voxels);
  const format::Vec3 factors = packed(scale);
  builder.Finish(format::CreateShape(builder, spheres, boxes, capsules, mesh, 0, cylinders, cones, ellipsoids, hulls,
                                     half_spaces, field, clouds, polylines, scale == Vec3::Ones() ? nullptr : &factors,
                                     0, solid != SaidSolid::surface, solid == SaidSolid::by_winding, voxels,
                                     is_unknown));
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

}  // namespace

Result<std::vector<std::uint8_t>> encode_shape(const Shape& shape, const Vec3& scale, const std::string& where,
                                               SaidSolid solid, bool is_unknown) {
  if (shape.empty()) { return bad_input(where + ": its shape has no part"); }
  if (!((scale.array() > 0).all() && scale.allFinite())) {
    return bad_input(where + ": its scale must be finite and above 0");
  }
  EncodedParts parts;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    const auto reason = std::visit([](const auto& part) { return part_fault(part); }, shape[i]);
    if (reason) { return bad_input(where + ": part " + std::to_string(i) + ": " + *reason); }
    const bool is_surface =
        std::holds_alternative<MeshShape>(shape[i]) || std::holds_alternative<HeightFieldShape>(shape[i]);
    if (is_surface && parts.has_surface()) {
      return bad_input(where + ": part " + std::to_string(i) + ": a second mesh; a shape holds at most one");
    }
    std::visit([&](const auto& part) { parts.add(part); }, shape[i]);
  }
  std::vector<std::uint8_t> bytes = build(parts, scale, solid, is_unknown);
  if (bytes.size() > kMaxShapeBytes) {
    return bad_input(where + ": its shape takes " + std::to_string(bytes.size()) + " bytes; allowed " +
                         std::to_string(kMaxShapeBytes),
                     "nothing was sent; let the server load it from a file, or simplify it");
  }
  return bytes;
}

}  // namespace collided::client
