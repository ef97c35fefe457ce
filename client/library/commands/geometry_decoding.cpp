#include "client/library/commands/geometry_decoding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "idl/geometry_generated.h"
#include "idl/scene_tables.hpp"
#include "idl/topics.hpp"
#include "idl/unit_quaternion.hpp"

namespace collided::client {
namespace {

/// Why data is invalid; thrown and caught in this file.
struct Flaw {
  const char* what;
};

Vec3 vector_of(const format::Vec3& from) {
  const Vec3 vector(from.x(), from.y(), from.z());
  if (!vector.allFinite()) throw Flaw{"a coordinate is not finite"};
  return vector;
}

Quat rotation_of(double w, double x, double y, double z) {
  const Quat rotation(w, x, y, z);
  if (!wire_contract::is_unit_quaternion(rotation)) throw Flaw{"a quaternion is not of unit length"};
  return rotation;
}

/// A rotation with these axes. It may reverse an axis, which does not change a box or an ellipsoid.
Quat rotation_of(const format::Mat3& axes) {
  Eigen::Matrix3d m;
  m.col(0) = vector_of(axes.column_0());
  m.col(1) = vector_of(axes.column_1());
  m.col(2) = vector_of(axes.column_2());
  if (!((m.transpose() * m).isIdentity(1e-9))) throw Flaw{"axes are not at right angles"};
  if (m.determinant() < 0) m.col(2) = -m.col(2);
  return Quat(m).normalized();
}

double size_of(double size) {
  if (!(size >= 0 && std::isfinite(size))) throw Flaw{"a size is below 0 or not finite"};
  return size;
}

Vec3 sizes_of(const format::Vec3& from) {
  const Vec3 sizes = vector_of(from);
  if ((sizes.array() < 0).any()) throw Flaw{"a size is below 0"};
  return sizes;
}

class ObjectsDecoder {
 public:
  /// byte_budget  bounds the memory. A valid buffer stores each number once; one whose tables share numbers could
  ///              otherwise make the decoder allocate any amount.
  explicit ObjectsDecoder(std::size_t byte_budget) : budget_(byte_budget) {}

  Shape primitives(const format::Shape& from) {
    Shape parts;
    add_parts(from, parts);
    return parts;
  }

  ShownObject object(const format::ShownObject& from, std::vector<NumberedRun>& runs) {
    spend(64);  // less than an object takes
    ShownObject object;
    object.id = from.id();
    object.name = text_of(from.name());
    object.scene = text_of(from.scene());
    object.moving = from.moving();
    object.stale = from.stale();
    if (from.filter() != nullptr) {
      object.layers = from.filter()->layers();
      object.mask = from.filter()->mask();
      object.group = from.filter()->group();
    }
    if (from.position() != nullptr) object.pose.position = vector_of(*from.position());
    if (const format::Quat* q = from.rotation()) object.pose.rotation = rotation_of(q->w(), q->x(), q->y(), q->z());
    if (from.shape() != nullptr) add_parts(*from.shape(), object.parts);
    each(from.runs(), [&](const format::Run& run) {
      runs.push_back({run.surface(), run.first_triangle(), run.triangle_count(), run.is_hull()});
    });
    return object;
  }

 private:
  std::string text_of(const flatbuffers::String* from) {
    if (from == nullptr) return {};
    if (from->size() > wire_contract::kMaxNameBytes) throw Flaw{"a name is too long"};
    spend(from->size());
    return from->str();
  }

  void spend(std::size_t byte_count) {
    if (byte_count > budget_) throw Flaw{"its tables share their numbers"};
    budget_ -= byte_count;
  }

  template <class Struct, class Use>
  void each(const flatbuffers::Vector<const Struct*>* from, const Use& use) {
    if (from == nullptr) return;
    spend(from->size() * sizeof(Struct));
    for (const Struct& one : format::copied<Struct>(from)) use(one);
  }

  void add_parts(const format::Shape& from, Shape& parts) {
    each(from.spheres(), [&](const format::Sphere& s) {
      parts.emplace_back(SphereShape{size_of(s.radius()), vector_of(s.center())});
    });
    add_boxes(from, parts);
    each(from.capsules(), [&](const format::Capsule& c) {
      parts.emplace_back(CapsuleShape{vector_of(c.a()), vector_of(c.b()), size_of(c.radius())});
    });
    each(from.cylinders(), [&](const format::Cylinder& c) {
      parts.emplace_back(CylinderShape{vector_of(c.a()), vector_of(c.b()), size_of(c.radius())});
    });
    each(from.cones(), [&](const format::Cone& c) {
      parts.emplace_back(ConeShape{vector_of(c.apex()), vector_of(c.base()), size_of(c.radius())});
    });
    each(from.ellipsoids(), [&](const format::Ellipsoid& e) {
      parts.emplace_back(EllipsoidShape{sizes_of(e.half()), vector_of(e.center()), rotation_of(e.axes())});
    });
    each(from.half_spaces(), [&](const format::HalfSpace& h) {
      parts.emplace_back(HalfSpaceShape{vector_of(h.normal()), vector_of(h.point())});
    });
  }

  void add_boxes(const format::Shape& from, Shape& parts) {
    std::vector<Quat> turned;
    each(from.box_axes(), [&](const format::Mat3& axes) { turned.push_back(rotation_of(axes)); });
    std::size_t i = 0;
    each(from.boxes(), [&](const format::Box& box) {
      if (!turned.empty() && i >= turned.size()) throw Flaw{"axes are not one a box"};
      const format::Quat& q = box.rotation();
      const Quat rotation = turned.empty() ? rotation_of(q.w(), q.x(), q.y(), q.z()) : turned[i];
      parts.emplace_back(BoxShape{sizes_of(box.half()), vector_of(box.center()), rotation});
      ++i;
    });
  }

  std::size_t budget_;
};

std::vector<SurfaceEdge> edges_of(const format::Surface& from, std::size_t vertex_count, std::size_t triangle_count) {
  const std::uint32_t count = from.edge_kinds() == nullptr ? 0 : from.edge_kinds()->size();
  if (std::uint64_t{count} * 4 != (from.edges() == nullptr ? 0 : from.edges()->size()))
    throw Flaw{"edges are not one a kind"};
  std::vector<SurfaceEdge> edges;
  edges.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t* numbers = from.edges()->data() + 4 * std::size_t{i};
    edges.push_back({{numbers[0], numbers[1]}, {numbers[2], numbers[3]}, from.edge_kinds()->Get(i)});
    const bool has_second = numbers[3] < triangle_count || numbers[3] == kNoTriangle;
    if (numbers[0] >= vertex_count || numbers[1] >= vertex_count || numbers[2] >= triangle_count || !has_second)
      throw Flaw{"an edge names what is not there"};
  }
  return edges;
}

Surface surface_of_mesh(const format::Mesh& from) {
  const auto& numbers = *from.vertices();
  const auto& corners = *from.corners();
  if (numbers.size() % 3 != 0 || corners.size() % 3 != 0) throw Flaw{"numbers are not by threes"};
  Surface surface;
  surface.vertices = format::copied<Vec3>(&numbers);
  for (const Vec3& vertex : surface.vertices) {
    if (!vertex.allFinite()) throw Flaw{"a vertex is not finite"};
  }
  surface.triangles = format::copied<std::array<std::uint32_t, 3>>(&corners);
  for (const auto& triangle : surface.triangles) {
    if (*std::max_element(triangle.begin(), triangle.end()) >= surface.vertices.size())
      throw Flaw{"a triangle names a vertex that is not there"};
  }
  return surface;
}

Surface surface_of(const format::Surface& from, const std::uint8_t*) {
  Surface surface = surface_of_mesh(*from.mesh());
  surface.edges = edges_of(from, surface.vertices.size(), surface.triangles.size());
  return surface;
}

Poses poses_of(const format::Poses& from, const std::uint8_t*) {
  const std::uint32_t count = from.ids()->size();
  if (std::uint64_t{from.poses()->size()} != std::uint64_t{wire_contract::kPoseNumbers} * count ||
      from.stale()->size() != count) {
    throw Flaw{"its columns differ in length"};
  }
  Poses poses{.epoch = from.epoch(),
              .version = from.version(),
              .table_version = from.table_version(),
              .world_time = std::chrono::nanoseconds(from.world_time_ns()),
              .ids = format::copied<std::uint64_t>(from.ids()),
              .poses = {},
              .stale = format::copied<std::uint8_t>(from.stale())};
  poses.poses.reserve(count);
  for (const auto& n : format::copied<std::array<double, wire_contract::kPoseNumbers>>(from.poses())) {
    const Vec3 position(n[0], n[1], n[2]);
    if (!position.allFinite()) throw Flaw{"a position is not finite"};
    poses.poses.push_back({position, rotation_of(n[3], n[4], n[5], n[6])});
  }
  return poses;
}

/// Returns work(root table, first byte) for a buffer, unless it is invalid.
template <class Table, class Work>
auto read_table(std::string_view text, std::string& flaw, const Work& work)
    -> std::optional<decltype(work(std::declval<const Table&>(), nullptr))> {
  try {
    if (text.size() < 8 || text.size() > format::kMaxBufferBytes) throw Flaw{"no buffer"};
    const format::AlignedBytes bytes(std::as_bytes(std::span(text)));
    const Table* root = format::verified<Table>(bytes.data(), text.size(), nullptr);
    if (root == nullptr) throw Flaw{"its tables do not check out"};
    return work(*root, bytes.data());
  } catch (const Flaw& found) {
    flaw = found.what;
    return std::nullopt;
  }
}

}  // namespace

std::optional<Page> decode_page(std::string_view text, std::string& flaw) {
  return read_table<format::Page>(text, flaw, [&](const format::Page& page, const std::uint8_t* first_byte) {
    // Refers to the bytes in the text, which outlives a copy.
    const auto first = static_cast<std::size_t>(page.bytes()->Data() - first_byte);
    return Page{page.transfer(), page.total(), page.first(), text.substr(first, page.bytes()->size())};
  });
}

std::optional<DecodedObjects> decode_objects(std::string_view text, std::string& flaw) {
  return read_table<format::ShownObjects>(text, flaw, [&](const format::ShownObjects& from, const std::uint8_t*) {
    DecodedObjects objects;
    objects.shown.epoch = from.epoch();
    objects.shown.version = from.version();
    objects.shown.table_version = from.table_version();
    objects.shown.world_time = std::chrono::nanoseconds(from.world_time_ns());
    ObjectsDecoder decoder(text.size());
    for (const format::ShownObject* object : *from.objects()) {
      objects.shown.objects.push_back(decoder.object(*object, objects.runs.emplace_back()));
    }
    return objects;
  });
}

std::optional<Shape> decode_primitives(const format::Shape& from, std::size_t byte_budget) {
  try {
    return ObjectsDecoder(byte_budget).primitives(from);
  } catch (const Flaw&) { return std::nullopt; }
}

std::optional<Surface> decode_mesh(const format::Mesh& from) {
  try {
    return surface_of_mesh(from);
  } catch (const Flaw&) { return std::nullopt; }
}

std::optional<WrittenSnapshot> decode_snapshot(std::string_view text, std::string& flaw) {
  const format::AlignedBytes aligned(std::as_bytes(std::span(text)));
  const auto* root = format::verified<format::Scene>(aligned.data(), text.size(), format::SceneIdentifier());
  if (root == nullptr || root->frozen() == nullptr) {
    flaw = "no snapshot, or damaged";
    return std::nullopt;
  }
  const format::Frozen& frozen = *root->frozen();
  WrittenSnapshot written{.version = frozen.version(),
                          .world_time = std::chrono::nanoseconds(frozen.world_time_ns()),
                          .parts = root->parts() == nullptr ? 0 : root->parts()->size(),
                          .objects = root->objects() == nullptr ? 0 : root->objects()->size(),
                          .triangles = root->mesh() == nullptr ? 0 : root->mesh()->corners()->size() / 3,
                          .bytes = text.size(),
                          .lacks = {}};
  for (std::uint32_t i = 0; frozen.lacks() != nullptr && i < frozen.lacks()->size(); ++i)
    written.lacks.push_back(frozen.lacks()->Get(i)->str());
  return written;
}

std::optional<Surface> decode_surface(std::string_view text, std::string& flaw) {
  return read_table<format::Surface>(text, flaw, surface_of);
}

std::optional<Poses> decode_poses(std::string_view text, std::string& flaw) {
  return read_table<format::Poses>(text, flaw, poses_of);
}

}  // namespace collided::client
