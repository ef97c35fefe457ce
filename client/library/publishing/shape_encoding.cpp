#include "client/library/publishing/shape_encoding.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>

#include "client/library/asking/question_encoding.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/scene_tables.hpp"
#include "idl/topics.hpp"

namespace collided::client {
namespace {

// A definition is one message; its other fields need far less than this.
constexpr std::size_t kHeaderRoomBytes = 16 * 1024;
constexpr std::size_t kMaxShapeBytes = wire_contract::kMaxMessageBytes - kHeaderRoomBytes;

/// Why a part is invalid; thrown and caught in this file.
struct PartFault {
  std::string why;
};

void refuse(std::optional<std::string> fault) {
  if (fault) throw PartFault{std::move(*fault)};
}

/// Checks a point or size; `name` is its name in a fault.
format::Vec3 valid_point(const Vec3& point, const char* name) {
  refuse(finite_fault(point, name));
  return format::packed(point);
}
double valid_size(double size, const char* name) {
  refuse(size_fault(size, name));
  return size;
}

void check_points(const std::vector<Vec3>& points, const std::string& name) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (auto found = finite_fault(points[i], name.c_str()))
      throw PartFault{*found + " (" + name + ' ' + std::to_string(i) + ')'};
  }
}

/// The numbers that values consist of.
template <class Number, class Value>
std::vector<Number> numbers_in(const std::vector<Value>& values) {
  std::vector<Number> numbers(values.size() * sizeof(Value) / sizeof(Number));
  if (!values.empty()) std::memcpy(numbers.data(), values.data(), values.size() * sizeof(Value));
  return numbers;
}

/// Checks parts and adds them to a table, or throws a PartFault.
class PartPacker {
 public:
  explicit PartPacker(format::ShapeT& to) : to_(to) {}

  void operator()(const SphereShape& s) {
    to_.spheres.push_back({valid_point(s.center, "center"), valid_size(s.radius_m, "radius")});
  }
  void operator()(const BoxShape& b) {
    refuse(fault(BoxQuestion{b.center, b.half_m, b.rotation}));
    to_.boxes.push_back({format::packed(b.center), format::packed(b.rotation), format::packed(b.half_m)});
  }
  void operator()(const CapsuleShape& c) {
    to_.capsules.push_back({valid_point(c.a, "end a"), valid_point(c.b, "end b"), valid_size(c.radius_m, "radius")});
  }
  void operator()(const CylinderShape& c) {
    to_.cylinders.push_back(along_axis<format::Cylinder>(c.a, c.b, c.radius_m));
  }
  void operator()(const ConeShape& c) { to_.cones.push_back(along_axis<format::Cone>(c.apex, c.base, c.radius_m)); }
  void operator()(const EllipsoidShape& e) {
    if (!(e.half_m.array() > 0).all()) throw PartFault{"half sizes must be above 0"};
    refuse(fault(BoxQuestion{e.center, e.half_m, e.rotation}));
    to_.ellipsoids.push_back(
        {format::packed(e.center), format::packed(e.rotation.toRotationMatrix()), format::packed(e.half_m)});
  }
  void operator()(const HullShape& hull) {
    if (hull.points.size() < 4) {
      throw PartFault{"a hull of " + std::to_string(hull.points.size()) + " points; at least 4 are needed"};
    }
    for (const Vec3& point : hull.points) refuse(finite_fault(point, "point"));
    to_.hulls.push_back(std::make_unique<format::MeshT>());
    to_.hulls.back()->vertices = numbers_in<double>(hull.points);
  }
  void operator()(const MeshShape& mesh) {
    if (mesh.triangles.empty()) throw PartFault{"a mesh without triangles"};
    check_points(mesh.vertices, "vertex");
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      const std::uint32_t largest = *std::max_element(mesh.triangles[i].begin(), mesh.triangles[i].end());
      if (largest >= mesh.vertices.size()) {
        throw PartFault{"triangle " + std::to_string(i) + " names vertex " + std::to_string(largest) + " of " +
                        std::to_string(mesh.vertices.size())};
      }
    }
    refuse_second_surface();
    to_.mesh = std::make_unique<format::MeshT>();
    to_.mesh->vertices = numbers_in<double>(mesh.vertices);
    to_.mesh->corners = numbers_in<std::uint32_t>(mesh.triangles);
  }
  void operator()(const HalfSpaceShape& h) {
    const format::HalfSpace packed{valid_point(h.point, "point"), valid_point(h.normal, "normal")};
    if (h.normal.isZero(0)) throw PartFault{"its normal is zero"};
    to_.half_spaces.push_back(packed);
  }
  void operator()(const HeightFieldShape& field) {
    if (field.columns < 2 || field.heights_m.size() < 2 * std::size_t{field.columns} ||
        field.heights_m.size() % field.columns != 0) {
      throw PartFault{"a height field of " + std::to_string(field.heights_m.size()) + " heights in " +
                      std::to_string(field.columns) + " columns; whole rows are needed, at least 2 of 2"};
    }
    if (!(field.spacing_x_m > 0 && field.spacing_y_m > 0 && std::isfinite(field.spacing_x_m + field.spacing_y_m))) {
      throw PartFault{"the spacings of a height field must be finite and above 0"};
    }
    for (std::size_t i = 0; i < field.heights_m.size(); ++i) {
      if (!std::isfinite(field.heights_m[i])) throw PartFault{"height " + std::to_string(i) + " is not finite"};
    }
    refuse_second_surface();
    format::HeightFieldT& to = *(to_.height_field = std::make_unique<format::HeightFieldT>());
    to.columns = field.columns;
    to.spacing_x = field.spacing_x_m, to.spacing_y = field.spacing_y_m;
    to.heights = field.heights_m;
  }
  void operator()(const CloudShape& cloud) { to_.clouds.push_back(points(cloud.points, cloud.radius_m, 1)); }
  void operator()(const PolylineShape& line) { to_.polylines.push_back(points(line.points, line.radius_m, 2)); }
  void operator()(const VoxelShape& voxels) {
    std::uint64_t cells = 1;
    for (const std::uint32_t size : voxels.size) {
      if (size < 1 || size > 256) throw PartFault{std::to_string(size) + " cells along an axis; allowed 1 to 256"};
      cells *= size;
    }
    if (!(voxels.cell_m > 0 && std::isfinite(voxels.cell_m)))
      throw PartFault{"cells of " + words(voxels.cell_m) + " m"};
    if (voxels.occupied.size() != (cells + 7) / 8) {
      throw PartFault{std::to_string(voxels.occupied.size()) + " bytes for " + std::to_string(cells) +
                      " cells; needed are " + std::to_string((cells + 7) / 8)};
    }
    format::VoxelsT& to = *to_.voxels.emplace_back(std::make_unique<format::VoxelsT>());
    to.cell = voxels.cell_m;
    to.low_x = voxels.low[0], to.low_y = voxels.low[1], to.low_z = voxels.low[2];
    to.columns = voxels.size[0], to.rows = voxels.size[1], to.layers = voxels.size[2];
    to.occupied = voxels.occupied;
  }

 private:
  template <class Struct>
  static Struct along_axis(const Vec3& a, const Vec3& b, double radius_m) {
    const format::Vec3 ends[] = {valid_point(a, "one end"), valid_point(b, "the other end")};
    if (a == b) throw PartFault{"both ends of its axis are the same point"};
    return {ends[0], ends[1], valid_size(radius_m, "radius")};
  }
  static std::unique_ptr<format::PointsT> points(const std::vector<Vec3>& points, double radius_m, std::size_t least) {
    if (points.size() < least) {
      throw PartFault{std::to_string(points.size()) + " points; at least " + std::to_string(least) + " are needed"};
    }
    check_points(points, "point");
    auto packed = std::make_unique<format::PointsT>();
    packed->radius = valid_size(radius_m, "radius");
    packed->points = numbers_in<double>(points);
    return packed;
  }
  void refuse_second_surface() const {
    if (to_.mesh || to_.height_field) throw PartFault{"a second mesh; a shape holds at most one"};
  }

  format::ShapeT& to_;
};

}  // namespace

Result<std::vector<std::uint8_t>> encode_shape(const Shape& shape, const Vec3& scale, const std::string& where,
                                               SaidSolid solid, bool is_unknown) {
  if (shape.empty()) { return bad_input(where + ": its shape has no part"); }
  if (!((scale.array() > 0).all() && scale.allFinite())) {
    return bad_input(where + ": its scale must be finite and above 0");
  }
  format::ShapeT table;
  PartPacker packer(table);
  for (std::size_t i = 0; i < shape.size(); ++i) {
    try {
      std::visit(packer, shape[i]);
    } catch (const PartFault& fault) { return bad_input(where + ": part " + std::to_string(i) + ": " + fault.why); }
  }
  if (scale != Vec3::Ones()) table.scale = std::make_unique<format::Vec3>(format::packed(scale));
  table.is_solid = solid != SaidSolid::surface;
  table.by_winding = solid == SaidSolid::by_winding;
  table.is_unknown = is_unknown;
  flatbuffers::FlatBufferBuilder builder;
  builder.Finish(format::CreateShape(builder, &table));
  std::vector<std::uint8_t> bytes(builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize());
  if (bytes.size() > kMaxShapeBytes) {
    return bad_input(where + ": its shape takes " + std::to_string(bytes.size()) + " bytes; allowed " +
                         std::to_string(kMaxShapeBytes),
                     "nothing was sent; let the server load it from a file, or simplify it");
  }
  return bytes;
}

}  // namespace collided::client
