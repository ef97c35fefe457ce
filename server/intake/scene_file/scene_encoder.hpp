#pragma once

#include <cstdint>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "idl/scene_tables.hpp"
#include "server/intake/scene.hpp"

// Encodes values as tables of idl/scene.fbs.
namespace collided::engine {

inline constexpr std::uint32_t kSceneFormat = 4;  // of snapshots; 1 had no checksum, 2 no allowed pairs
inline constexpr std::uint32_t kPairsFormat = 3;
/// This bit is set in every checksum, so that none is 0: FlatBuffers does not store a 0.
inline constexpr std::uint64_t kIsChecksum = std::uint64_t{1} << 32;

/// Values as structs of the schema.
using format::packed;
inline format::Filter packed(const Filter& from) { return {from.layers, from.mask, from.group}; }
static_assert(sizeof(Aabb) == 6 * sizeof(double), "boxes are written as low and high");

/// Builds the tables of one FlatBuffers buffer. Call mesh(), shape() or scene() for the root, then bytes().
/// threads  one at a time; meshes that are shared must outlive it
class SceneEncoder {
 public:
  explicit SceneEncoder(std::size_t byte_count) : builder_(byte_count) {}

  /// The table of a mesh. Its numbers are copied as they are in memory.
  flatbuffers::Offset<format::Mesh> mesh(const TriangleMesh& from) {
    const auto vertices = format::write_numbers<double>(builder_, from.vertices);
    return format::CreateMesh(builder_, vertices, format::write_numbers<std::uint32_t>(builder_, from.triangles));
  }

  /// The table of a mesh that several objects share; written once.
  flatbuffers::Offset<format::Mesh> shared_mesh(const TriangleMesh* from) {
    flatbuffers::Offset<format::Mesh>& known = meshes_[from];
    if (known.IsNull()) known = mesh(*from);
    return known;
  }

  /// The table of a shape.
  flatbuffers::Offset<format::Shape> shape(const Shape& from) {
    Parts parts;
    for (const Primitive& primitive : from.primitives) {
      std::visit([&](const auto& one) { add(one, parts); }, primitive);
    }
    if (parts.rotations_suffice) parts.box_axes.clear();
    const auto mesh_table = from.mesh ? shared_mesh(from.mesh.get()) : 0;
    const auto axes = optional(parts.box_axes);
    const auto hulls = parts.hull_tables.empty() ? 0 : builder_.CreateVector(parts.hull_tables);
    return format::CreateShape(builder_, optional(parts.spheres), optional(parts.boxes), optional(parts.capsules),
                               mesh_table, axes, optional(parts.cylinders), optional(parts.cones),
                               optional(parts.ellipsoids), hulls, optional(parts.half_spaces), {}, {}, {}, nullptr, {},
                               false, false, {}, from.is_unknown);
  }

  /// Writes a whole scene as the root.
  void scene(const Scene& from) {
    std::vector<flatbuffers::Offset<format::Part>> parts;
    for (const Part& part : from.parts) {
      const format::Filter filter = packed(part.filter);
      const auto name = builder_.CreateString(part.name);
      const auto pieces = piece_numbers(part.cut);
      parts.push_back(format::CreatePart(builder_, name, part.first_triangle, part.triangle_count, &filter, pieces,
                                         solid_code(part.solid)));
    }
    std::vector<flatbuffers::Offset<format::Object>> objects;
    for (const SceneObject& object : from.objects) {
      const auto name = builder_.CreateString(object.name);
      const auto shape_table = shape(object.shape);
      const format::Vec3 position = packed(object.pose.position);
      const format::Quat rotation = packed(object.pose.rotation);
      const format::Filter filter = packed(object.filter);
      const auto pieces = piece_numbers(object.cut);
      objects.push_back(format::CreateObject(builder_, name, shape_table, &position, &rotation, &filter, pieces,
                                             solid_code(object.solid)));
    }
    const bool has_mesh = !from.mesh.vertices.empty() || !from.mesh.triangles.empty();
    const auto mesh_table = has_mesh ? mesh(from.mesh) : 0;
    const auto name = builder_.CreateString(from.name);
    const auto part_vector = builder_.CreateVector(parts);
    const auto object_vector = builder_.CreateVector(objects);
    const auto collapses = from.collapses.empty() ? 0 : format::write_numbers<std::uint32_t>(builder_, from.collapses);
    const bool is_every_pair = from.allowed_pairs && from.allowed_pairs->is_every_pair();
    const auto allowed_pairs = pair_numbers(from);
    const auto frozen_table = from.frozen ? frozen(*from.frozen) : 0;
    const std::uint32_t format = from.frozen ? kSceneFormat : from.allowed_pairs ? kPairsFormat : kPairsFormat - 1;
    format::FinishSceneBuffer(
        builder_, format::CreateScene(builder_, format, name, mesh_table, part_vector, object_vector, collapses,
                                      kIsChecksum, allowed_pairs, is_every_pair, frozen_table));
  }

  /// Makes a shape the root.
  void finish(flatbuffers::Offset<format::Shape> root) { builder_.Finish(root); }

  /// Access for tables of other schemas that contain tables of this one.
  flatbuffers::FlatBufferBuilder& builder() { return builder_; }

  std::span<const std::byte> bytes() const {
    return std::as_bytes(std::span(builder_.GetBufferPointer(), builder_.GetSize()));
  }
  std::span<std::byte> bytes() {
    return std::as_writable_bytes(std::span(builder_.GetBufferPointer(), builder_.GetSize()));
  }

 private:
  static format::Solid solid_code(const std::optional<SolidBy>& solid) {
    if (!solid) return format::Solid::surface;
    return *solid == SolidBy::winding ? format::Solid::winding : format::Solid::closing;
  }

  flatbuffers::Offset<format::Frozen> frozen(const FrozenWorld& from) {
    const auto order = from.order.empty() ? 0 : builder_.CreateVector(from.order);
    const auto covers = from.covers ? format::write_numbers<double>(builder_, *from.covers) : 0;
    const auto lacks = builder_.CreateVectorOfStrings(from.lacks);
    return format::CreateFrozen(builder_, from.version, from.world_time_ns, order, from.covers.has_value(), covers,
                                lacks);
  }

  flatbuffers::Offset<flatbuffers::Vector<std::uint32_t>> piece_numbers(const CutTriangles& cut) {
    return cut.piece_of ? builder_.CreateVector(*cut.piece_of) : 0;
  }

  /// A shape's primitives by kind. Hulls are in the buffer already.
  struct Parts : format::ShapeT {
    std::vector<flatbuffers::Offset<format::Mesh>> hull_tables;
    bool rotations_suffice = true;  // false: boxes need box_axes
  };

  // A box is stored by its rotation, and also by its axes if the rotation does not give exactly the same bits.
  void add(const Sphere& sphere, Parts& parts) { parts.spheres.emplace_back(packed(sphere.center), sphere.radius_m); }
  void add(const Capsule& c, Parts& parts) { parts.capsules.emplace_back(packed(c.a), packed(c.b), c.radius_m); }
  void add(const Cylinder& c, Parts& parts) { parts.cylinders.emplace_back(packed(c.a), packed(c.b), c.radius_m); }
  void add(const Cone& c, Parts& parts) { parts.cones.emplace_back(packed(c.apex), packed(c.base), c.radius_m); }
  void add(const Ellipsoid& e, Parts& parts) {
    parts.ellipsoids.emplace_back(packed(e.center), packed(e.axes), packed(e.half_m));
  }
  void add(const HalfSpace& h, Parts& parts) { parts.half_spaces.emplace_back(packed(h.point), packed(h.normal)); }
  void add(const Hull& hull, Parts& parts) { parts.hull_tables.push_back(mesh(*hull.mesh)); }
  void add(const Box& box, Parts& parts) {
    const Quat rotation = box.axes.determinant() > 0 ? Quat(box.axes).normalized() : Quat::Identity();
    parts.rotations_suffice = parts.rotations_suffice && rotation.toRotationMatrix() == box.axes;
    parts.boxes.emplace_back(packed(box.center), packed(rotation), packed(box.half_m));
    parts.box_axes.emplace_back(packed(box.axes));
  }

  /// The objects' allowed pairs, by the objects' indexes in the file.
  flatbuffers::Offset<flatbuffers::Vector<std::uint32_t>> pair_numbers(const Scene& from) {
    if (!from.allowed_pairs || from.allowed_pairs->pairs().empty()) return 0;
    std::unordered_map<std::uint32_t, std::uint32_t> place_of;
    for (std::uint32_t i = 0; i < from.objects.size(); ++i) place_of.emplace(from.objects[i].number, i);
    std::vector<std::uint32_t> numbers;
    for (const auto& [low, high] : from.allowed_pairs->pairs()) {
      if (!place_of.contains(low) || !place_of.contains(high)) continue;
      numbers.insert(numbers.end(), {place_of.at(low), place_of.at(high)});
    }
    return builder_.CreateVector(numbers);
  }

  // A vector that is left out if it is empty.
  template <class Struct>
  flatbuffers::Offset<flatbuffers::Vector<const Struct*>> optional(const std::vector<Struct>& structs) {
    return structs.empty() ? 0 : builder_.CreateVectorOfStructs(structs);
  }

  flatbuffers::FlatBufferBuilder builder_;
  std::unordered_map<const TriangleMesh*, flatbuffers::Offset<format::Mesh>> meshes_;
};

/// Upper bounds on the bytes that a mesh or a shape takes in the buffer.
inline std::uint64_t encoded_bytes(const TriangleMesh& mesh) {
  return mesh.vertices.size() * sizeof(Vec3) + mesh.triangles.size() * sizeof(TriangleCorners) + 64;
}

inline std::uint64_t encoded_bytes(const Shape& shape) {
  std::uint64_t bytes = 192 * shape.primitives.size() + (shape.mesh ? encoded_bytes(*shape.mesh) : 0) + 192;
  for (const Primitive& primitive : shape.primitives) {
    if (const auto* hull = std::get_if<Hull>(&primitive)) { bytes += encoded_bytes(*hull->mesh); }
  }
  return bytes;
}

/// An upper bound on the bytes that the buffer will have.
inline std::uint64_t encoded_bytes(const Scene& scene) {
  std::uint64_t bytes =
      1024 + encoded_bytes(scene.mesh) + scene.name.size() + scene.collapses.size() * sizeof(EdgeCollapse);
  if (scene.allowed_pairs) bytes += scene.allowed_pairs->pairs().size() * sizeof(NumberPair);
  for (const Part& part : scene.parts) {
    bytes += 128 + part.name.size() + sizeof(std::uint32_t) * part.cut.piece_count();
  }
  std::unordered_set<const TriangleMesh*> meshes;  // one that several objects share is written once
  for (const SceneObject& object : scene.objects) {
    bytes += 256 + object.name.size() + encoded_bytes(object.shape) + sizeof(std::uint32_t) * object.cut.piece_count();
    const TriangleMesh* const mesh = object.shape.mesh.get();
    if (mesh != nullptr && !meshes.insert(mesh).second) bytes -= encoded_bytes(*mesh);
  }
  if (scene.frozen) {
    bytes += 256 + sizeof(std::uint32_t) * scene.frozen->order.size();
    if (scene.frozen->covers) bytes += sizeof(Aabb) * scene.frozen->covers->size();
    for (const std::string& lack : scene.frozen->lacks) bytes += 16 + lack.size();
  }
  return bytes;
}

}  // namespace collided::engine
