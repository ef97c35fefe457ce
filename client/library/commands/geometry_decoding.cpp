#include "client/library/commands/geometry_decoding.hpp"

#include <cmath>
#include <cstring>

#include "idl/geometry_generated.h"
#include "idl/topics.hpp"
#include "idl/unit_quaternion.hpp"

namespace collided::client {
namespace {

/// Depth of tables allowed. A proper buffer has objects, object, shape.
constexpr std::uint32_t kMaxDepth = 5;

/// Why something does not hold; thrown and caught in this file.
struct Flaw {
  const char* what;
};

/// A verified copy of a buffer, at a suitable alignment, which text need not have.
template <class Table>
class Verified {
 public:
  explicit Verified(std::string_view text) : words_(text.size() / sizeof(std::uint64_t) + 1) {
    // FlatBuffers cannot address more: its offsets have 31 bits.
    if (text.size() < 8 || text.size() >= (std::size_t{1} << 31)) throw Flaw{"no buffer"};
    std::memcpy(words_.data(), text.data(), text.size());
    const auto* bytes = reinterpret_cast<const std::uint8_t*>(words_.data());
    // A table takes at least 8 bytes, so more tables than that must share bytes, and verifying them could take for
    // ever.
    flatbuffers::Verifier verifier(bytes, text.size(), kMaxDepth, static_cast<std::uint32_t>(text.size() / 8 + 1));
    if (!verifier.VerifyBuffer<Table>(nullptr)) throw Flaw{"its tables do not check out"};
    root_ = flatbuffers::GetRoot<Table>(bytes);
  }
  const Table* operator->() const { return root_; }
  const Table& operator*() const { return *root_; }
  /// Where a byte of the copy stands in the text.
  std::size_t offset_of(const std::uint8_t* byte) const {
    return static_cast<std::size_t>(byte - reinterpret_cast<const std::uint8_t*>(words_.data()));
  }

 private:
  std::vector<std::uint64_t> words_;
  const Table* root_ = nullptr;
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

/// A rotation with these axes. An axis may be reversed, which makes no difference to a box or an ellipsoid.
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

/// A number or struct, copied, since the verifier does not guarantee that 8-byte numbers are aligned.
template <class Number>
Number at(const flatbuffers::Vector<Number>& numbers, std::size_t i) {
  Number number;
  std::memcpy(&number, numbers.Data() + i * sizeof number, sizeof number);
  return number;
}

class ObjectsDecoder {
 public:
  /// byte_budget  bounds the memory. A proper buffer stores each number once; one whose tables share numbers could
  ///              otherwise make the decoder allocate any amount.
  explicit ObjectsDecoder(std::size_t byte_budget) : budget_(byte_budget) {}

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
    for (std::size_t i = 0; i < from->size(); ++i) {
      Struct one;
      std::memcpy(static_cast<void*>(&one), from->Data() + i * sizeof(Struct), sizeof one);
      use(one);
    }
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
  const std::size_t count = from.edge_kinds() == nullptr ? 0 : from.edge_kinds()->size();
  if (count * 4 != (from.edges() == nullptr ? 0 : from.edges()->size())) throw Flaw{"edges are not one a kind"};
  std::vector<SurfaceEdge> edges(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto number = [&](std::size_t k) { return from.edges()->Get(static_cast<std::uint32_t>(4 * i + k)); };
    SurfaceEdge& edge = edges[i];
    edge = {{number(0), number(1)}, {number(2), number(3)}, from.edge_kinds()->Get(static_cast<std::uint32_t>(i))};
    const bool names_points = edge.ends[0] < vertex_count && edge.ends[1] < vertex_count;
    const bool has_second = edge.triangles[1] < triangle_count || edge.triangles[1] == kNoTriangle;
    if (!names_points || edge.triangles[0] >= triangle_count || !has_second)
      throw Flaw{"an edge names what is not there"};
  }
  return edges;
}

Surface surface_of(const format::Surface& from) {
  const auto& numbers = *from.mesh()->vertices();
  const auto& corners = *from.mesh()->corners();
  if (numbers.size() % 3 != 0 || corners.size() % 3 != 0) throw Flaw{"numbers are not by threes"};
  Surface surface;
  surface.vertices.reserve(numbers.size() / 3);
  for (std::uint32_t i = 0; i < numbers.size(); i += 3) {
    surface.vertices.emplace_back(at(numbers, i), at(numbers, i + 1), at(numbers, i + 2));
    if (!surface.vertices.back().allFinite()) throw Flaw{"a vertex is not finite"};
  }
  surface.triangles.reserve(corners.size() / 3);
  for (std::uint32_t i = 0; i < corners.size(); i += 3) {
    surface.triangles.push_back({corners.Get(i), corners.Get(i + 1), corners.Get(i + 2)});
    for (const std::uint32_t corner : surface.triangles.back()) {
      if (corner >= surface.vertices.size()) throw Flaw{"a triangle names a vertex that is not there"};
    }
  }
  surface.edges = edges_of(from, surface.vertices.size(), surface.triangles.size());
  return surface;
}

Poses poses_of(const format::Poses& from) {
  const std::uint32_t count = from.ids()->size();
  const auto& numbers = *from.poses();
  if (std::uint64_t{numbers.size()} != std::uint64_t{wire_contract::kPoseNumbers} * count ||
      from.stale()->size() != count) {
    throw Flaw{"its columns differ in length"};
  }
  Poses poses{.epoch = from.epoch(),
              .version = from.version(),
              .table_version = from.table_version(),
              .world_time = std::chrono::nanoseconds(from.world_time_ns()),
              .ids = {},
              .poses = {},
              .stale = {}};
  for (std::uint32_t i = 0; i < count; ++i) poses.ids.push_back(at(*from.ids(), i));
  poses.stale.assign(from.stale()->begin(), from.stale()->end());
  poses.poses.reserve(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto number = [&](std::uint32_t k) { return at(numbers, std::size_t{wire_contract::kPoseNumbers} * i + k); };
    const Vec3 position(number(0), number(1), number(2));
    if (!position.allFinite()) throw Flaw{"a position is not finite"};
    poses.poses.push_back({position, rotation_of(number(3), number(4), number(5), number(6))});
  }
  return poses;
}

template <class Work>
auto unless_flawed(std::string& flaw, const Work& work) -> std::optional<decltype(work())> {
  try {
    return work();
  } catch (const Flaw& found) {
    flaw = found.what;
    return std::nullopt;
  }
}

}  // namespace

std::optional<Page> decode_page(std::string_view text, std::string& flaw) {
  return unless_flawed(flaw, [&] {
    const Verified<format::Page> page(text);
    // The same bytes in the text, which outlives the copy.
    const std::string_view bytes = text.substr(page.offset_of(page->bytes()->Data()), page->bytes()->size());
    return Page{page->transfer(), page->total(), page->first(), bytes};
  });
}

std::optional<DecodedObjects> decode_objects(std::string_view text, std::string& flaw) {
  return unless_flawed(flaw, [&] {
    const Verified<format::ShownObjects> from(text);
    DecodedObjects decoded;
    decoded.shown.epoch = from->epoch();
    decoded.shown.version = from->version();
    decoded.shown.table_version = from->table_version();
    decoded.shown.world_time = std::chrono::nanoseconds(from->world_time_ns());
    ObjectsDecoder decoder(text.size());
    for (const format::ShownObject* object : *from->objects()) {
      decoded.shown.objects.push_back(decoder.object(*object, decoded.runs.emplace_back()));
    }
    return decoded;
  });
}

std::optional<Surface> decode_surface(std::string_view text, std::string& flaw) {
  return unless_flawed(flaw, [&] { return surface_of(*Verified<format::Surface>(text)); });
}

std::optional<Poses> decode_poses(std::string_view text, std::string& flaw) {
  return unless_flawed(flaw, [&] { return poses_of(*Verified<format::Poses>(text)); });
}

}  // namespace collided::client
