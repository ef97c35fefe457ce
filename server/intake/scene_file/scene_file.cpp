#include "server/intake/scene_file/scene_file.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <cmath>
#include <cstring>
#include <unordered_map>
#include <unordered_set>

#include "idl/scene_generated.h"
#include "server/geometry/convex_hull.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/intake/file_bytes.hpp"
#include "server/intake/limits.hpp"
#include "server/intake/mesh/shape_scale.hpp"
#include "server/intake/readers/names.hpp"
#include "server/intake/readers/vertex_buffer.hpp"
#include "server/intake/scene_file/scene_encoder.hpp"
#include "server/intake/scene_file/scene_index.hpp"
#include "server/intake/scene_file/write_file.hpp"

namespace collided::engine {
namespace {

static_assert(sizeof(Collapse) == 2 * sizeof(std::uint32_t));
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(TriangleCorners) == 3 * sizeof(std::uint32_t));

/// Offsets of FlatBuffers are 31 bits; the rest is for names and tables.
constexpr std::uint64_t kMaxSceneFileBytes = (std::uint64_t{1} << 31) - 1;

/// A hull is tested by all of its corners.
constexpr std::size_t kMaxHullPoints = 4096;

/// Lengths of normals whose squares and products are far from the ends of the range of double.
constexpr double kLeastNormal = 1e-30;

/// Scene, object, shape, mesh: an honest buffer goes no deeper.
constexpr std::uint32_t kMaxDepth = 5;

/// What is wrong with a buffer, without a file name and a consequence; never leaves this file.
struct Flaw {
  std::string what;
};

/// Structs and numbers of 8 bytes of a FlatBuffers vector are copied out: the verifier does not promise their alignment.
template <class Struct>
std::vector<Struct> copied(const flatbuffers::Vector<const Struct*>* vector) {
  std::vector<Struct> copies(vector == nullptr ? 0 : vector->size());
  if (!copies.empty()) { std::memcpy(copies.data(), vector->Data(), copies.size() * sizeof(Struct)); }
  return copies;
}

double number_at(const flatbuffers::Vector<double>& numbers, std::size_t i) {
  double number;
  std::memcpy(&number, numbers.Data() + i * sizeof number, sizeof number);
  return number;
}

/// Turns a verified buffer into values and checks what they mean.
class Decoder {
 public:
  /// byte_budget  the buffer's own size. An honest buffer stores each number once; one that lets many tables share
  ///              a mesh could otherwise ask for any amount of memory.
  Decoder(std::uint64_t byte_budget, std::uint64_t max_triangles, std::uint64_t max_primitives)
      : byte_budget_(byte_budget), triangle_budget_(max_triangles), primitive_budget_(max_primitives) {}

  TriangleMesh mesh(const format::Mesh& from) {
    const auto& numbers = *from.vertices();
    const auto& corners = *from.corners();
    if (numbers.size() % 3 != 0 || corners.size() % 3 != 0) {
      throw Flaw{fmt::format("mesh of {} coordinates and {} corners, both must be multiples of 3", numbers.size(),
                             corners.size())};
    }
    spend_triangles(corners.size() / 3);
    spend_bytes(8 * std::uint64_t{numbers.size()} + 4 * std::uint64_t{corners.size()});
    TriangleMesh mesh;
    mesh.vertices.resize(numbers.size() / 3);
    mesh.triangles.resize(corners.size() / 3);
    if (!mesh.vertices.empty()) {
      std::memcpy(mesh.vertices.data()->data(), numbers.Data(), mesh.vertices.size() * sizeof(Vec3));
    }
    if (!mesh.triangles.empty()) {
      std::memcpy(mesh.triangles.data(), corners.Data(), mesh.triangles.size() * sizeof(TriangleCorners));
    }
    check(mesh);
    return mesh;
  }

  Shape shape(const format::Shape& from) {
    Shape shape;
    add_spheres(from, shape);
    add_boxes(from, shape);
    add_capsules(from, shape);
    add_cylinders(from, shape);
    add_cones(from, shape);
    add_ellipsoids(from, shape);
    add_hulls(from, shape);
    add_clouds(from, shape);
    add_polylines(from, shape);
    add_half_spaces(from, shape);
    add_surface(from, shape);
    add_buffers(from, shape);
    if (shape.empty()) { throw Flaw{"shape of nothing"}; }
    if (from.scale() != nullptr) { apply_scale(point(*from.scale(), "scale"), shape); }
    return shape;
  }

  Vec3 point(const format::Vec3& from, std::string_view what) const {
    const Vec3 point(from.x(), from.y(), from.z());
    if (!point.allFinite()) { throw Flaw{fmt::format("{} is ({}, {}, {})", what, point[0], point[1], point[2])}; }
    return point;
  }

  Quat rotation(const format::Quat& from, std::string_view what) const {
    Quat rotation(from.w(), from.x(), from.y(), from.z());
    const double norm = rotation.norm();
    if (!(std::abs(norm - 1) <= kUnitNormSlack)) {
      throw Flaw{fmt::format("{} has quaternion norm {}, allowed 1 +- {}", what, norm, kUnitNormSlack)};
    }
    if (std::abs(rotation.squaredNorm() - 1) > kNormalizedSlack) { rotation.coeffs() /= norm; }
    return rotation;
  }

 private:
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
  template <class Struct>
  std::vector<Struct> take(const flatbuffers::Vector<const Struct*>* vector) {
    const std::uint64_t count = vector == nullptr ? 0 : vector->size();
    spend_primitives(count);
    spend_bytes(count * sizeof(Struct));
    return copied(vector);
  }

  void check(const TriangleMesh& mesh) const {
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      const Vec3& v = mesh.vertices[i];
      if (!v.allFinite()) { throw Flaw{fmt::format("vertex {} is ({}, {}, {})", i, v[0], v[1], v[2])}; }
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (mesh.triangles[i][k] >= mesh.vertices.size()) {
          throw Flaw{fmt::format("triangle {}: corner {} is vertex {} of {}", i, k, mesh.triangles[i][k],
                                 mesh.vertices.size())};
        }
      }
    }
  }

  double size(double value, std::string_view what) const {
    if (!(value >= 0 && std::isfinite(value))) {
      throw Flaw{fmt::format("{} {} m, allowed are finite sizes of 0 and more", what, value)};
    }
    return value;
  }

  void add_spheres(const format::Shape& from, Shape& shape) {
    const auto spheres = take(from.spheres());
    for (std::size_t i = 0; i < spheres.size(); ++i) {
      const std::string name = fmt::format("sphere {}: ", i);
      shape.primitives.push_back(Sphere{point(spheres[i].center(), name + "center"),  //
                                        size(spheres[i].radius(), name + "radius")});
    }
  }

  void add_boxes(const format::Shape& from, Shape& shape) {
    const auto boxes = take(from.boxes());
    const auto axes = take(from.box_axes());
    if (!axes.empty() && axes.size() != boxes.size()) {
      throw Flaw{fmt::format("axes for {} boxes of {}", axes.size(), boxes.size())};
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const std::string name = fmt::format("box {}: ", i);
      Box box{.center = point(boxes[i].center(), name + "center"),
              .axes = axes.empty() ? rotation(boxes[i].rotation(), name + "rotation").toRotationMatrix()
                                   : unit_axes(axes[i], name + "axes"),
              .half_m = point(boxes[i].half(), name + "half size")};
      for (int axis = 0; axis < 3; ++axis) { size(box.half_m[axis], name + "half size"); }
      shape.primitives.push_back(box);
    }
  }

  Mat3 unit_axes(const format::Mat3& from, std::string_view what) const {
    Mat3 axes;
    axes << point(from.column_0(), what), point(from.column_1(), what), point(from.column_2(), what);
    if (!((axes.transpose() * axes - Mat3::Identity()).cwiseAbs().maxCoeff() <= 2 * kUnitNormSlack)) {
      throw Flaw{fmt::format("{} are not of length 1 at right angles within {}", what, 2 * kUnitNormSlack)};
    }
    return axes;
  }

  void add_capsules(const format::Shape& from, Shape& shape) {
    const auto capsules = take(from.capsules());
    for (std::size_t i = 0; i < capsules.size(); ++i) {
      const std::string name = fmt::format("capsule {}: ", i);
      shape.primitives.push_back(Capsule{point(capsules[i].a(), name + "end a"), point(capsules[i].b(), name + "end b"),
                                         size(capsules[i].radius(), name + "radius")});
    }
  }

  /// Both ends of an axis, which has a direction.
  std::pair<Vec3, Vec3> axis(const format::Vec3& from, const format::Vec3& to, const std::string& name) const {
    std::pair<Vec3, Vec3> ends{point(from, name + "one end"), point(to, name + "the other end")};
    if (ends.first == ends.second) { throw Flaw{name + "both ends of the axis are the same point"}; }
    return ends;
  }

  void add_cylinders(const format::Shape& from, Shape& shape) {
    const auto cylinders = take(from.cylinders());
    for (std::size_t i = 0; i < cylinders.size(); ++i) {
      const std::string name = fmt::format("cylinder {}: ", i);
      const auto [a, b] = axis(cylinders[i].a(), cylinders[i].b(), name);
      shape.primitives.push_back(Cylinder{a, b, size(cylinders[i].radius(), name + "radius")});
    }
  }

  void add_cones(const format::Shape& from, Shape& shape) {
    const auto cones = take(from.cones());
    for (std::size_t i = 0; i < cones.size(); ++i) {
      const std::string name = fmt::format("cone {}: ", i);
      const auto [apex, base] = axis(cones[i].apex(), cones[i].base(), name);
      shape.primitives.push_back(Cone{apex, base, size(cones[i].radius(), name + "radius")});
    }
  }

  void add_ellipsoids(const format::Shape& from, Shape& shape) {
    const auto ellipsoids = take(from.ellipsoids());
    for (std::size_t i = 0; i < ellipsoids.size(); ++i) {
      const std::string name = fmt::format("ellipsoid {}: ", i);
      const Ellipsoid ellipsoid{point(ellipsoids[i].center(), name + "center"),
                                unit_axes(ellipsoids[i].axes(), name + "axes"),
                                point(ellipsoids[i].half(), name + "half size")};
      for (int k = 0; k < 3; ++k) {
        if (!(ellipsoid.half_m[k] > 0)) {
          throw Flaw{fmt::format("{}half size {} m, allowed are sizes above 0", name, ellipsoid.half_m[k])};
        }
      }
      shape.primitives.push_back(ellipsoid);
    }
  }

  /// The points of a cloud or a line.
  std::vector<Vec3> points(const format::Points& from, const std::string& name) {
    const auto& numbers = *from.points();
    if (numbers.size() % 3 != 0 || numbers.size() == 0) {
      throw Flaw{fmt::format("{}{} coordinates, must be a multiple of 3 above 0", name, numbers.size())};
    }
    spend_primitives(numbers.size() / 3);
    spend_bytes(8 * std::uint64_t{numbers.size()});
    size(from.radius(), name + "radius");
    std::vector<Vec3> points(numbers.size() / 3);
    std::memcpy(points.data()->data(), numbers.Data(), points.size() * sizeof(Vec3));
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
    for (std::size_t i = 0; i < half_spaces.size(); ++i) {
      const std::string name = fmt::format("half-space {}: ", i);
      const HalfSpace one{point(half_spaces[i].point(), name + "point"),
                          point(half_spaces[i].normal(), name + "normal")};
      if (const double length = one.normal.stableNorm(); !(length >= kLeastNormal && length <= 1 / kLeastNormal)) {
        throw Flaw{
            fmt::format("{}normal of length {}, allowed {} to {}", name, length, kLeastNormal, 1 / kLeastNormal)};
      }
      shape.primitives.push_back(one);
    }
    const bool in_company = shape.primitives.size() > 1 || from.mesh() != nullptr || from.height_field() != nullptr;
    if (!half_spaces.empty() && in_company) {
      throw Flaw{"a half-space with other parts: it has no end, so it makes an object of its own"};
    }
  }

  TriangleMesh height_field(const format::HeightField& from) {
    const auto& heights = *from.heights();
    const std::uint64_t columns = from.columns();
    const std::uint64_t rows = columns == 0 ? 0 : heights.size() / columns;
    if (columns < 2 || rows < 2 || heights.size() != columns * rows) {
      throw Flaw{fmt::format("height field of {} heights in {} columns, needed are whole rows, 2 of 2 at least",
                             heights.size(), columns)};
    }
    for (const double spacing : {from.spacing_x(), from.spacing_y()}) {
      if (!(spacing > 0 && std::isfinite(spacing * static_cast<double>(heights.size())))) {
        throw Flaw{fmt::format("height field: spacing {} m, allowed are finite lengths above 0", spacing)};
      }
    }
    spend_triangles(2 * (columns - 1) * (rows - 1));
    spend_bytes(8 * std::uint64_t{heights.size()});
    TriangleMesh mesh;
    mesh.vertices.reserve(heights.size());
    mesh.triangles.reserve(2 * (columns - 1) * (rows - 1));
    for (std::uint32_t i = 0; i < heights.size(); ++i) {
      const double height = number_at(heights, i);
      mesh.vertices.emplace_back(static_cast<double>(i % columns) * from.spacing_x(),
                                 static_cast<double>(i / columns) * from.spacing_y(), height);
      if (!std::isfinite(height)) { throw Flaw{fmt::format("height field: height {} is {}", i, height)}; }
      if (i % columns == columns - 1 || i / columns == rows - 1) continue;
      const std::uint32_t above = i + static_cast<std::uint32_t>(columns);
      mesh.triangles.push_back({i, i + 1, above + 1});
      mesh.triangles.push_back({i, above + 1, above});
    }
    return mesh;
  }

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

  void apply_scale(const Vec3& factor, Shape& shape) {
    if (factor == Vec3::Ones()) return;
    if (shape.mesh) {
      // A copy of its own.
      spend_triangles(shape.mesh->triangles.size());
      spend_bytes(8 * 3 * shape.mesh->vertices.size());
    }
    if (const std::string reason = scale(shape, factor); !reason.empty()) { throw Flaw{reason}; }
  }

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

Filter filter_of(const format::Filter* from) {
  return from == nullptr ? Filter{} : Filter{from->layers(), from->mask(), from->group()};
}

/// Takes each name of a scene once.
class NameCheck {
 public:
  std::string take(const flatbuffers::String& name) {
    const std::string_view text(name.c_str(), name.size());
    if (const std::string flaw = flaw_of_name(text); !flaw.empty()) {
      throw Flaw{fmt::format("name {} {}", quoted(text), flaw)};
    }
    if (!taken_.insert(text).second) { throw Flaw{fmt::format("two parts or objects have the name {}", quoted(text))}; }
    return std::string(text);
  }

 private:
  std::unordered_set<std::string_view> taken_;
};

/// from  a part or an object, of triangle_count triangles
template <class Table>
CutTriangles decode_pieces(const Table& from, const char* kind, std::uint64_t triangle_count) {
  if (from.piece_of() == nullptr || from.piece_of()->size() == 0) { return {}; }
  std::vector<std::uint32_t> pieces(from.piece_of()->begin(), from.piece_of()->end());
  const std::uint64_t whole_count = triangle_count - std::min<std::uint64_t>(pieces.size(), triangle_count);
  for (const std::uint32_t whole : pieces) {
    if (whole >= whole_count) {
      throw Flaw{fmt::format("{} {} has a piece of triangle {}, allowed are those before {}", kind,
                             quoted(from.name()->string_view()), whole, whole_count)};
    }
  }
  return {std::make_shared<const std::vector<std::uint32_t>>(std::move(pieces))};
}

void decode_parts(const format::Scene& from, NameCheck& names, Scene& scene) {
  const std::uint64_t triangle_count = scene.mesh.triangles.size();
  std::uint64_t covered = 0;
  for (std::uint32_t i = 0; from.parts() != nullptr && i < from.parts()->size(); ++i) {
    const format::Part& part = *from.parts()->Get(i);
    if (part.first_triangle() != covered || part.triangle_count() == 0 ||
        part.triangle_count() > triangle_count - covered) {
      throw Flaw{fmt::format("part {} is {} triangles from {}; parts must follow each other from {} up to {}", i,
                             part.triangle_count(), part.first_triangle(), covered, triangle_count)};
    }
    covered += part.triangle_count();
    scene.parts.push_back({names.take(*part.name()), part.first_triangle(), part.triangle_count(),
                           filter_of(part.filter()), decode_pieces(part, "part", part.triangle_count())});
  }
  if (covered != triangle_count) { throw Flaw{fmt::format("parts cover {} of {} triangles", covered, triangle_count)}; }
}

CollapseOrder decode_collapses(const format::Scene& from, std::size_t vertex_count) {
  const auto* numbers = from.collapses();
  if (numbers == nullptr) return {};
  if (numbers->size() % 2 != 0 || numbers->size() / 2 > vertex_count) {
    throw Flaw{fmt::format("{} numbers of collapses, allowed are twos, at most one for each of {} vertices",
                           numbers->size(), vertex_count)};
  }
  CollapseOrder order(numbers->size() / 2);
  if (!order.empty()) std::memcpy(order.data(), numbers->Data(), order.size() * sizeof(Collapse));
  if (const std::string flaw = flaw_of(order, vertex_count); !flaw.empty()) throw Flaw{flaw};
  return order;
}

Scene decode_scene(const format::Scene& from, std::uint64_t byte_budget, std::uint64_t max_triangles) {
  Decoder decoder(byte_budget, max_triangles, byte_budget);
  Scene scene;
  scene.name = from.name()->str();
  if (const std::string flaw = flaw_of_name(scene.name); !flaw.empty()) {
    throw Flaw{fmt::format("scene name {} {}", quoted(scene.name), flaw)};
  }
  if (from.mesh() != nullptr) { scene.mesh = decoder.mesh(*from.mesh()); }
  scene.collapses = decode_collapses(from, scene.mesh.vertices.size());
  NameCheck names;
  decode_parts(from, names, scene);
  for (std::uint32_t i = 0; from.objects() != nullptr && i < from.objects()->size(); ++i) {
    const format::Object& object = *from.objects()->Get(i);
    std::string name = names.take(*object.name());
    try {
      Pose pose;
      if (object.position() != nullptr) { pose.position = decoder.point(*object.position(), "position"); }
      if (object.rotation() != nullptr) { pose.rotation = decoder.rotation(*object.rotation(), "rotation"); }
      Shape shape = decoder.shape(*object.shape());
      const std::size_t triangle_count = shape.mesh ? shape.mesh->triangles.size() : 0;
      scene.objects.push_back({name,
                               std::move(shape),
                               pose,
                               filter_of(object.filter()),
                               {},
                               decode_pieces(object, "object", triangle_count)});
    } catch (const Flaw& flaw) { throw Flaw{fmt::format("object {}: {}", quoted(name), flaw.what)}; }
  }
  return scene;
}

/// The bytes at an address where doubles may lie: themselves, or a copy.
class AlignedBytes {
 public:
  AlignedBytes(const void* data, std::size_t byte_count) : data_(static_cast<const std::uint8_t*>(data)) {
    if (reinterpret_cast<std::uintptr_t>(data) % alignof(double) != 0) {
      copy_.resize(byte_count / sizeof(std::uint64_t) + 1);
      std::memcpy(copy_.data(), data, byte_count);
      data_ = reinterpret_cast<const std::uint8_t*>(copy_.data());
    }
  }
  const std::uint8_t* data() const { return data_; }

 private:
  std::vector<std::uint64_t> copy_;
  const std::uint8_t* data_;
};

/// The root table of a buffer whose structure is sound, or null.
template <class Table>
const Table* verified(const std::uint8_t* data, std::size_t byte_count, const char* identifier) {
  if (byte_count > kMaxSceneFileBytes) { return nullptr; }
  // A table has 8 bytes at least, so more tables than that are shared ones: verifying them all could take for ever.
  flatbuffers::Verifier verifier(data, byte_count, kMaxDepth, static_cast<std::uint32_t>(byte_count / 8 + 1));
  return verifier.VerifyBuffer<Table>(identifier) ? flatbuffers::GetRoot<Table>(data) : nullptr;
}

/// Where the checksum stands in verified tables; nothing where they have none.
std::optional<std::size_t> checksum_place(const std::uint8_t* data) {
  const std::uint8_t* at = flatbuffers::GetRoot<flatbuffers::Table>(data)->GetAddressOf(format::Scene::VT_CHECKSUM);
  return at == nullptr ? std::nullopt : std::optional(static_cast<std::size_t>(at - data));
}

std::uint64_t checksum_of(const std::uint8_t* data, std::size_t byte_count, std::size_t place) {
  constexpr std::uint8_t kZeros[sizeof(std::uint64_t)] = {};
  const std::size_t after = place + sizeof kZeros;
  uLong sum = crc32_z(0, data, place);
  sum = crc32_z(sum, kZeros, sizeof kZeros);
  return kIsChecksum | crc32_z(sum, data + after, byte_count - after);
}

/// Decoding finds what makes no sense; a number that is another one makes sense.
void check_whole(const format::Scene& root, const std::uint8_t* data, std::size_t byte_count) {
  if (root.format() < 1 || root.format() > kSceneFormat) {
    throw Flaw{fmt::format("scene format {}, this program reads up to {}", root.format(), kSceneFormat)};
  }
  const std::optional<std::size_t> place = checksum_place(data);
  const bool fits = place ? root.checksum() == checksum_of(data, byte_count, *place) : root.format() == 1;
  if (!fits) throw Flaw{"cut or damaged: its checksum is not that of its bytes"};
}

Scene decode_scene_bytes(const void* bytes, std::size_t byte_count, std::uint64_t max_triangles) {
  const AlignedBytes aligned(bytes, byte_count);
  const auto* root = verified<format::Scene>(aligned.data(), byte_count, format::SceneIdentifier());
  if (root == nullptr) { throw Flaw{"not a scene file, or a damaged one: its tables do not check out"}; }
  check_whole(*root, aligned.data(), byte_count);
  return decode_scene(*root, byte_count, max_triangles);
}

}  // namespace

Scene read_scene_file(const Reading& reading) {
  try {
    Scene scene = decode_scene_bytes(reading.bytes.data(), table_bytes(reading.bytes), reading.options.max_triangles);
    if (!attach_indexes(reading.bytes, reading.keeper, scene)) {
      reading.report.warnings.emplace_back("the list of saved indexes is damaged; they are built anew");
    }
    return scene;
  } catch (const Flaw& flaw) { refuse(reading, flaw.what); }
}

void seal_scene(std::span<std::byte> tables) {
  const AlignedBytes aligned(tables.data(), tables.size());
  if (verified<format::Scene>(aligned.data(), tables.size(), format::SceneIdentifier()) == nullptr) return;
  const std::optional<std::size_t> place = checksum_place(aligned.data());
  if (!place) return;
  const std::uint64_t sum = checksum_of(aligned.data(), tables.size(), *place);
  std::memcpy(tables.data() + *place, &sum, sizeof sum);
}

namespace {

/// put(pieces) -> what went wrong, or nothing
template <class Put>
void save_scene_by(const std::string& name, const Scene& scene, const Put& put) {
  const auto fail = [&](const std::string& what) {
    throw LoadError(fmt::format("{}: {}. Nothing was written.", name, what));
  };
  if (const std::uint64_t bytes = encoded_bytes(scene); bytes > kMaxSceneFileBytes) {
    fail(fmt::format("the scene needs {} bytes, limit {}", bytes, kMaxSceneFileBytes));
  }
  SceneEncoder encoder(encoded_bytes(scene));
  encoder.scene(scene);
  seal_scene(encoder.bytes());
  const std::span<const std::byte> bytes = encoder.bytes();
  try {
    decode_scene_bytes(bytes.data(), bytes.size(), kMaxVertices);
  } catch (const Flaw& flaw) { fail(flaw.what); }
  std::vector<std::byte> padding;
  std::vector<std::byte> list;
  std::vector<std::span<const std::byte>> pieces = index_section(scene, bytes.size(), padding, list);
  pieces.insert(pieces.begin(), bytes);
  if (const std::string failure = put(pieces); !failure.empty()) { fail(failure); }
}

}  // namespace

void save_scene(const std::string& path, const Scene& scene) {
  save_scene_by(file_name(path), scene, [&](const auto& pieces) { return replace_file(path, pieces); });
}

void save_scene(int file, const std::string& name, const Scene& scene) {
  save_scene_by(name, scene, [&](const auto& pieces) { return write_file(file, pieces); });
}

DecodedShape decode_shape(std::span<const std::byte> bytes, const ShapeLimits& limits) {
  if (bytes.size() > limits.max_bytes) {
    return {std::nullopt, fmt::format("{} bytes, limit {}", bytes.size(), limits.max_bytes)};
  }
  const AlignedBytes aligned(bytes.data(), bytes.size());
  const auto* root = verified<format::Shape>(aligned.data(), bytes.size(), nullptr);
  if (root == nullptr) { return {std::nullopt, "not a shape, or a damaged one: its tables do not check out"}; }
  try {
    return {Decoder(bytes.size(), limits.max_triangles, limits.max_primitives).shape(*root), {}};
  } catch (const Flaw& flaw) { return {std::nullopt, flaw.what}; }
}

std::vector<std::byte> encode_shape(const Shape& shape) {
  SceneEncoder encoder(encoded_bytes(shape));
  encoder.finish(encoder.shape(shape));
  const std::span<const std::byte> bytes = encoder.bytes();
  return {bytes.begin(), bytes.end()};
}

}  // namespace collided::engine
