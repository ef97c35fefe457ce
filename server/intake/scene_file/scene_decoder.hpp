#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "idl/scene_tables.hpp"
#include "idl/unit_quaternion.hpp"
#include "server/geometry/convex_hull.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/intake/limits.hpp"
#include "server/intake/mesh/shape_scale.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/readers/vertex_buffer.hpp"
#include "server/intake/voxel_cells.hpp"
#include "server/intake/scene.hpp"

// Decodes untrusted tables of idl/scene.fbs to values.
namespace collided::engine {

/// Most points of a hull: each test of a hull goes through all of its corners.
inline constexpr std::size_t kMaxHullPoints = 4096;

/// Normals of half-spaces have lengths from this to its inverse, so that their squares and products stay well within
/// the range of double.
inline constexpr double kLeastNormal = 1e-30;

/// The flaw of a buffer. It is thrown, and the caller adds the file name and the consequence.
struct Flaw {
  std::string what;
};

/// The filter of a table, or the default one if it has none.
inline Filter filter_of(const format::Filter* from) {
  return from == nullptr ? Filter{} : Filter{from->layers(), from->mask(), from->group()};
}

/// The origins of the pieces of a part or object with that many triangles. Throws a Flaw.
template <class Table>
CutTriangles cut_of(const Table& from, const char* kind, std::uint64_t triangle_count) {
  std::vector<std::uint32_t> pieces = format::copied<std::uint32_t>(from.piece_of());
  if (pieces.empty()) return {};
  const std::uint64_t whole_count = triangle_count - std::min<std::uint64_t>(pieces.size(), triangle_count);
  for (const std::uint32_t whole : pieces) {
    if (whole >= whole_count) {
      throw Flaw{fmt::format("{} {} has a piece of triangle {}, allowed are those before {}", kind,
                             in_quotes(from.name()->string_view()), whole, whole_count)};
    }
  }
  return {std::make_shared<const std::vector<std::uint32_t>>(std::move(pieces))};
}

/// Turns the tables of a verified buffer into values and checks their meaning. Every function throws a Flaw if
/// something is invalid.
/// threads  one at a time
class SceneDecoder {
 public:
  /// byte_budget  the buffer's size, which bounds the memory that the values take. A proper buffer stores each number
  ///              once; a buffer in which many tables share a mesh could otherwise make the decoder allocate any
  ///              amount.
  SceneDecoder(std::uint64_t byte_budget, std::uint64_t max_triangles, std::uint64_t max_primitives)
      : byte_budget_(byte_budget), triangle_budget_(max_triangles), primitive_budget_(max_primitives) {}

  /// A mesh with finite vertices and vertex numbers in range.
  TriangleMesh mesh(const format::Mesh& from) {
    const auto& numbers = *from.vertices();
    const auto& corners = *from.corners();
    if (numbers.size() % 3 != 0 || corners.size() % 3 != 0) {
      throw Flaw{fmt::format("mesh of {} coordinates and {} corners, both must be multiples of 3", numbers.size(),
                             corners.size())};
    }
    spend_triangles(corners.size() / 3);
    spend_bytes(8 * std::uint64_t{numbers.size()} + 4 * std::uint64_t{corners.size()});
    TriangleMesh mesh{format::copied<Vec3>(&numbers), format::copied<TriangleCorners>(&corners)};
    check(mesh);
    return mesh;
  }

  /// A shape with at least one part, scaled.
  Shape shape(const format::Shape& from) {
    Shape shape;
    each("sphere", take(from.spheres()), shape, [&](const format::Sphere& s) {
      return Sphere{point(s.center(), "center"), size(s.radius(), "radius")};
    });
    add_boxes(from, shape);
    each("capsule", take(from.capsules()), shape, [&](const format::Capsule& c) {
      return Capsule{point(c.a(), "end a"), point(c.b(), "end b"), size(c.radius(), "radius")};
    });
    each("cylinder", take(from.cylinders()), shape, [&](const format::Cylinder& c) {
      const auto [a, b] = axis(c.a(), c.b());
      return Cylinder{a, b, size(c.radius(), "radius")};
    });
    each("cone", take(from.cones()), shape, [&](const format::Cone& c) {
      const auto [apex, base] = axis(c.apex(), c.base());
      return Cone{apex, base, size(c.radius(), "radius")};
    });
    each("ellipsoid", take(from.ellipsoids()), shape, [&](const format::Ellipsoid& e) { return ellipsoid(e); });
    add_hulls(from, shape);
    add_clouds(from, shape);
    add_polylines(from, shape);
    add_half_spaces(from, shape);
    add_surface(from, shape);
    add_buffers(from, shape);
    add_voxels(from, shape);
    shape.is_unknown = from.is_unknown();
    if (shape.empty()) { throw Flaw{"shape of nothing"}; }
    if (from.scale() != nullptr) { apply_scale(point(*from.scale(), "scale"), shape); }
    if (const std::string reason = beyond_limit(shape); !reason.empty()) throw Flaw{reason};
    return shape;
  }

  /// A point of coordinates; `what` names it in a Flaw.
  static Vec3 point(const format::Vec3& from, std::string_view what) {
    const Vec3 point(from.x(), from.y(), from.z());
    if (const std::string reason = beyond_limit(point); !reason.empty())
      throw Flaw{fmt::format("{} is {}", what, reason)};
    return point;
  }

  /// A quaternion of norm 1 within kUnitNormSlack, normalized if it is off by more than rounding.
  static Quat rotation(const format::Quat& from, std::string_view what) {
    Quat rotation(from.w(), from.x(), from.y(), from.z());
    const double norm = rotation.norm();
    static_assert(kUnitNormSlack == wire_contract::kUnitQuaternionSlack);
    if (!wire_contract::is_unit_quaternion(rotation)) {
      throw Flaw{fmt::format("{} has quaternion norm {}, allowed 1 +- {}", what, norm, kUnitNormSlack)};
    }
    if (std::abs(rotation.squaredNorm() - 1) > kNormalizedSlack) { rotation.coeffs() /= norm; }
    return rotation;
  }

 private:
  // The needs of a buffer are taken off the budgets before memory is allocated.
  void spend_triangles(std::uint64_t count) {
    if (count > triangle_budget_) {
      throw Flaw{fmt::format("{} triangles, {} more are allowed", count, triangle_budget_)};
    }
    triangle_budget_ -= count;
  }
  void spend_bytes(std::uint64_t count) {
    if (count > byte_budget_) { throw Flaw{"tables share their numbers, so that it would grow beyond its own size"}; }
    byte_budget_ -= count;
  }
  void spend_primitives(std::uint64_t count) {
    if (count > primitive_budget_) {
      throw Flaw{fmt::format("{} primitives, {} more are allowed", count, primitive_budget_)};
    }
    primitive_budget_ -= count;
  }
  /// The primitives of one kind, taken off the budgets.
  template <class Struct>
  std::vector<Struct> take(const flatbuffers::Vector<const Struct*>* vector) {
    const std::uint64_t count = vector == nullptr ? 0 : vector->size();
    spend_primitives(count);
    spend_bytes(count * sizeof(Struct));
    return format::copied<Struct>(vector);
  }

  /// Adds the result of make(struct) for each struct. The text of a flaw begins with the kind and the number of the
  /// struct.
  template <class Struct, class Make>
  static void each(const char* kind, const std::vector<Struct>& structs, Shape& shape, const Make& make) {
    for (std::size_t i = 0; i < structs.size(); ++i) {
      try {
        shape.primitives.push_back(make(structs[i]));
      } catch (const Flaw& flaw) { throw Flaw{fmt::format("{} {}: {}", kind, i, flaw.what)}; }
    }
  }

  /// Finite vertices, and vertex numbers in range.
  static void check(const TriangleMesh& mesh) {
    if (const std::string reason = beyond_limit(mesh); !reason.empty()) throw Flaw{reason};
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (mesh.triangles[i][k] >= mesh.vertices.size()) {
          throw Flaw{fmt::format("triangle {}: corner {} is vertex {} of {}", i, k, mesh.triangles[i][k],
                                 mesh.vertices.size())};
        }
      }
    }
  }

  /// A finite length of 0 or more; `what` names it in a Flaw.
  static double size(double value, std::string_view what) {
    if (!(value >= 0 && std::isfinite(value))) {
      throw Flaw{fmt::format("{} {} m, allowed are finite sizes of 0 and more", what, value)};
    }
    return value;
  }

  void add_boxes(const format::Shape& from, Shape& shape) {
    const auto boxes = take(from.boxes());
    const auto axes = take(from.box_axes());
    if (!axes.empty() && axes.size() != boxes.size()) {
      throw Flaw{fmt::format("axes for {} boxes of {}", axes.size(), boxes.size())};
    }
    std::size_t i = 0;
    each("box", boxes, shape, [&](const format::Box& b) {
      Box box{.center = point(b.center(), "center"),
              .axes = axes.empty() ? rotation(b.rotation(), "rotation").toRotationMatrix() : unit_axes(axes[i++]),
              .half_m = point(b.half(), "half size")};
      for (int axis = 0; axis < 3; ++axis) { size(box.half_m[axis], "half size"); }
      return box;
    });
  }

  /// Three unit vectors at right angles, within the slack of unit quaternions.
  static Mat3 unit_axes(const format::Mat3& from) {
    Mat3 axes;
    axes << point(from.column_0(), "axes"), point(from.column_1(), "axes"), point(from.column_2(), "axes");
    if (!((axes.transpose() * axes - Mat3::Identity()).cwiseAbs().maxCoeff() <= 2 * kUnitNormSlack)) {
      throw Flaw{fmt::format("axes are not of length 1 at right angles within {}", 2 * kUnitNormSlack)};
    }
    return axes;
  }

  /// Both ends of an axis; they differ.
  static std::pair<Vec3, Vec3> axis(const format::Vec3& from, const format::Vec3& to) {
    std::pair<Vec3, Vec3> ends{point(from, "one end"), point(to, "the other end")};
    if (ends.first == ends.second) { throw Flaw{"both ends of the axis are the same point"}; }
    return ends;
  }

  static Ellipsoid ellipsoid(const format::Ellipsoid& from) {
    const Ellipsoid ellipsoid{point(from.center(), "center"), unit_axes(from.axes()), point(from.half(), "half size")};
    for (int k = 0; k < 3; ++k) {
      if (!(ellipsoid.half_m[k] > 0)) {
        throw Flaw{fmt::format("half size {} m, allowed are sizes above 0", ellipsoid.half_m[k])};
      }
    }
    return ellipsoid;
  }

  /// The points of a cloud or polyline.
  std::vector<Vec3> points(const format::Points& from, const std::string& name) {
    const auto& numbers = *from.points();
    if (numbers.size() % 3 != 0 || numbers.size() == 0) {
      throw Flaw{fmt::format("{}{} coordinates, must be a multiple of 3 above 0", name, numbers.size())};
    }
    spend_primitives(numbers.size() / 3);
    spend_bytes(8 * std::uint64_t{numbers.size()});
    size(from.radius(), name + "radius");
    std::vector<Vec3> points = format::copied<Vec3>(&numbers);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& p = points[i];
      if (!p.allFinite()) { throw Flaw{fmt::format("{}point {} is ({}, {}, {})", name, i, p[0], p[1], p[2])}; }
    }
    return points;
  }

  void add_clouds(const format::Shape& from, Shape& shape) {
    for (std::uint32_t i = 0; from.clouds() != nullptr && i < from.clouds()->size(); ++i) {
      const format::Points& cloud = *from.clouds()->Get(i);
      for (const Vec3& center : points(cloud, fmt::format("cloud {}: ", i))) {
        shape.primitives.push_back(Sphere{center, cloud.radius()});
      }
    }
  }

  void add_polylines(const format::Shape& from, Shape& shape) {
    for (std::uint32_t i = 0; from.polylines() != nullptr && i < from.polylines()->size(); ++i) {
      const format::Points& line = *from.polylines()->Get(i);
      const std::vector<Vec3> along = points(line, fmt::format("polyline {}: ", i));
      if (along.size() < 2) { throw Flaw{fmt::format("polyline {}: one point, at least 2 are needed", i)}; }
      for (std::size_t k = 1; k < along.size(); ++k) {
        shape.primitives.push_back(Capsule{along[k - 1], along[k], line.radius()});
      }
    }
  }

  void add_half_spaces(const format::Shape& from, Shape& shape) {
    const auto half_spaces = take(from.half_spaces());
    each("half-space", half_spaces, shape, [&](const format::HalfSpace& h) {
      const HalfSpace half_space{point(h.point(), "point"), point(h.normal(), "normal")};
      const double length = half_space.normal.stableNorm();
      if (!(length >= kLeastNormal && length <= 1 / kLeastNormal)) {
        throw Flaw{fmt::format("normal of length {}, allowed {} to {}", length, kLeastNormal, 1 / kLeastNormal)};
      }
      return half_space;
    });
    const bool in_company = shape.primitives.size() > 1 || from.mesh() != nullptr || from.height_field() != nullptr;
    if (!half_spaces.empty() && in_company) {
      throw Flaw{"a half-space with other parts: it has no end, so it makes an object of its own"};
    }
  }

  /// The two triangles of each cell share the diagonal from a point to the next one of the next row.
  TriangleMesh height_field(const format::HeightField& from) {
    const std::uint64_t count = from.heights()->size();
    const std::uint64_t columns = from.columns();
    const std::uint64_t rows = columns == 0 ? 0 : count / columns;
    if (columns < 2 || rows < 2 || count != columns * rows) {
      throw Flaw{fmt::format("height field of {} heights in {} columns, needed are whole rows, 2 of 2 at least", count,
                             columns)};
    }
    for (const double spacing : {from.spacing_x(), from.spacing_y()}) {
      if (!(spacing > 0 && std::isfinite(spacing * static_cast<double>(count)))) {
        throw Flaw{fmt::format("height field: spacing {} m, allowed are finite lengths above 0", spacing)};
      }
    }
    spend_triangles(2 * (columns - 1) * (rows - 1));
    spend_bytes(8 * count);
    const std::vector<double> heights = format::copied<double>(from.heights());
    TriangleMesh mesh;
    mesh.vertices.reserve(count);
    mesh.triangles.reserve(2 * (columns - 1) * (rows - 1));
    for (std::uint32_t i = 0; i < count; ++i) {
      const auto column = static_cast<std::uint32_t>(i % columns);
      const auto row = static_cast<std::uint32_t>(i / columns);
      if (!std::isfinite(heights[i])) { throw Flaw{fmt::format("height field: height {} is {}", i, heights[i])}; }
      mesh.vertices.emplace_back(column * from.spacing_x(), row * from.spacing_y(), heights[i]);
      if (column == columns - 1 || row == rows - 1) continue;
      const std::uint32_t above = i + static_cast<std::uint32_t>(columns);
      mesh.triangles.push_back({i, i + 1, above + 1});
      mesh.triangles.push_back({i, above + 1, above});
    }
    return mesh;
  }

  /// The mesh or the height field.
  void add_surface(const format::Shape& from, Shape& shape) {
    if (from.mesh() != nullptr && from.height_field() != nullptr) {
      throw Flaw{"a mesh and a height field; a shape holds one of them"};
    }
    if (from.height_field() != nullptr) {
      shape.mesh = std::make_shared<const TriangleMesh>(height_field(*from.height_field()));
    }
    if (from.mesh() == nullptr) return;
    // Objects that name one mesh share it.
    std::shared_ptr<const TriangleMesh>& known = meshes_[from.mesh()];
    if (!known) known = std::make_shared<const TriangleMesh>(mesh(*from.mesh()));
    if (known->triangles.empty()) { throw Flaw{"mesh without triangles"}; }
    shape.mesh = known;
  }

  /// Vertex buffers; at most one of them may form a surface.
  void add_buffers(const format::Shape& from, Shape& shape) {
    for (std::uint32_t i = 0; from.buffers() != nullptr && i < from.buffers()->size(); ++i) {
      const format::VertexBuffer& buffer = *from.buffers()->Get(i);
      const std::string name = fmt::format("buffer {}: ", i);
      const auto bytes_of = [](const flatbuffers::Vector<std::uint8_t>* bytes) {
        return bytes == nullptr ? std::span<const std::byte>() : std::as_bytes(std::span(bytes->data(), bytes->size()));
      };
      const VertexBuffer read{static_cast<BufferKind>(buffer.kind()),
                              buffer.is_double(),
                              buffer.stride(),
                              buffer.offset(),
                              bytes_of(buffer.vertices()),
                              buffer.index_bytes(),
                              bytes_of(buffer.indices())};
      // A corner makes at most one piece of a kind; a vertex in doubles takes twice the bytes of one in floats.
      const std::uint64_t corners =
          read.index_bytes == 0 ? read.vertices.size() / 12 : read.indices.size() / read.index_bytes;
      spend_bytes(std::max(read.vertices.size(), read.indices.size()));
      read.kind >= BufferKind::triangles ? spend_triangles(corners) : spend_primitives(corners);
      std::variant<Shape, std::string> taken = shape_of_buffer(read, buffer.radius());
      if (const auto* flaw = std::get_if<std::string>(&taken)) throw Flaw{name + *flaw};
      const Shape& part = std::get<Shape>(taken);
      if (part.mesh && shape.mesh) throw Flaw{name + "a second surface; a shape holds one"};
      if (part.mesh) shape.mesh = part.mesh;
      shape.primitives.insert(shape.primitives.end(), part.primitives.begin(), part.primitives.end());
    }
  }

  void add_voxels(const format::Shape& from, Shape& shape) {
    for (std::uint32_t i = 0; from.voxels() != nullptr && i < from.voxels()->size(); ++i) {
      const format::Voxels& one = *from.voxels()->Get(i);
      const VoxelCells cells{.cell_m = one.cell(),
                             .low = {one.low_x(), one.low_y(), one.low_z()},
                             .size = {one.columns(), one.rows(), one.layers()},
                             .occupied = std::span(one.occupied()->data(), one.occupied()->size())};
      const std::string name = fmt::format("voxels {}: ", i);
      if (const std::string flaw = flaw_of(cells); !flaw.empty()) throw Flaw{name + flaw};
      // Each box takes far more memory than its bit, so the bytes of the bits do not pay for it.
      spend_primitives(occupied_count(cells));
      add_boxes_of(cells, shape.primitives);
    }
  }

  void apply_scale(const Vec3& factor, Shape& shape) {
    if (factor == Vec3::Ones()) return;
    if (shape.mesh) {
      // The scaled mesh is a copy, which is not shared with other objects.
      spend_triangles(shape.mesh->triangles.size());
      spend_bytes(8 * 3 * shape.mesh->vertices.size());
    }
    if (const std::string reason = scale(shape, factor); !reason.empty()) { throw Flaw{reason}; }
  }

  /// Hulls are computed from their points; corners in the file are ignored.
  void add_hulls(const format::Shape& from, Shape& shape) {
    for (std::uint32_t i = 0; from.hulls() != nullptr && i < from.hulls()->size(); ++i) {
      const TriangleMesh points = mesh(*from.hulls()->Get(i));
      if (points.vertices.size() > kMaxHullPoints) {
        throw Flaw{fmt::format("hull {}: {} points, allowed are {}", i, points.vertices.size(), kMaxHullPoints)};
      }
      std::optional<TriangleMesh> hull = convex_hull(points.vertices);
      if (!hull) {
        throw Flaw{fmt::format("hull {}: its {} points lie in one plane, or beyond the range of exact arithmetic", i,
                               points.vertices.size())};
      }
      shape.primitives.push_back(Hull{std::make_shared<const TriangleMesh>(std::move(*hull))});
    }
  }

  std::uint64_t byte_budget_;
  std::uint64_t triangle_budget_;
  std::uint64_t primitive_budget_;
  std::unordered_map<const format::Mesh*, std::shared_ptr<const TriangleMesh>> meshes_;
};

}  // namespace collided::engine
