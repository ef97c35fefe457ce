#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "collided/codes.hpp"
#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/pose.hpp"
#include "server/geometry/shape.hpp"
#include "server/intake/scene.hpp"
#include "server/world/objects/indirect_value.hpp"
#include "server/world/objects/shared_primitives.hpp"

namespace collided::engine {

/// Slot in the low 32 bits, generation in the high ones: a reused slot gives another id.
using ObjectId = std::uint64_t;

inline std::uint32_t slot_of(ObjectId id) { return static_cast<std::uint32_t>(id); }
/// Counts the objects of the slot, from 1.
inline std::uint32_t generation_of(ObjectId id) { return static_cast<std::uint32_t>(id >> 32); }

/// Set in the id of a fence; fences have slots of their own.
using codes::kStandingBit;
inline bool is_fence(ObjectId id) { return (id & kStandingBit) != 0; }
/// Set in the id of a fence that is a question for the nearest object. Generations stay below it.
inline constexpr ObjectId kNearestBit = ObjectId{1} << 62;
inline bool is_nearest_question(ObjectId id) { return is_fence(id) && (id & kNearestBit) != 0; }

using codes::LostPolicy;

/// A mesh with its index, both in the mesh's own frame; shared by every object that has the mesh.
struct IndexedMesh {
  std::shared_ptr<const TriangleMesh> mesh;
  Bvh tree;
  double radius_m = 0;  // largest distance of a vertex from the mesh's origin
};

/// Marks an object that is not a part of a static scene.
inline constexpr std::uint32_t kNoScenePart = 0xffffffff;

struct IndexedParts;  // part_index.hpp
struct SceneLevel;    // scene_levels.hpp
struct SolidMesh;     // server/world/solids
struct WindingMesh;   // server/world/solids

/// The objects of its scene that an object may touch without a contact.
struct AllowedPartners {
  std::shared_ptr<const AllowedPairs> pairs;  // pairs of the scene; null: none
  std::uint32_t number = 0;                   // number of the object in them

  bool contain(const AllowedPartners& other) const {
    return pairs && pairs == other.pairs && pairs->contains(number, other.number);
  }
  bool operator==(const AllowedPartners&) const = default;
};

/// Properties that few objects have.
struct RareInfo {
  std::string scene;                          // scene that it was loaded with; empty: added at run time
  std::shared_ptr<const IndexedParts> parts;  // index over the primitives; null: visit each
  std::shared_ptr<const SolidMesh> solid;     // what the mesh or the part encloses; null: it is a surface
  // Content of an open mesh by its winding number, used only by `inside` and signed near; all else treats it as a
  // surface. Null if not requested, or if the mesh is closed.
  std::shared_ptr<const WindingMesh> winding;
  CutTriangles cut;  // which original triangle each piece of the object's belongs to
  AllowedPartners allowed;
};

/// The properties of an object besides its pose. Immutable: a new definition creates a new one.
struct ObjectInfo {
  ObjectId id = 0;
  std::string name;
  Filter filter;
  bool moving = false;
  // Its content is unknown: it touches nothing, and an answer that depends on its space is undecided.
  bool is_unknown = false;
  bool has_allowed_pairs = false;  // see rare->allowed
  LostPolicy lost_policy = LostPolicy::remove;
  std::uint64_t publisher = 0;              // 0: the server's own
  SharedPrimitives primitives;              // in the object's frame
  std::shared_ptr<const IndexedMesh> mesh;  // in the object's frame; null for a part of a static scene
  IndirectValue<RareInfo> rare;
  std::uint32_t scene_part = kNoScenePart;  // number of the part, if the object is a run of static triangles
  std::uint32_t part_triangles = 0;         // triangles of the part, or of a mesh with triangles cut by mending

  /// The number by which answers name a triangle.
  std::uint32_t reported_triangle(std::uint32_t triangle) const { return rare->cut.told(triangle, part_triangles); }
};

/// True if a contact of the two counts, apart from the rules for pairs. Symmetric in a and b.
inline bool may_meet(const ObjectInfo& a, const ObjectInfo& b) {
  if (!may_meet(a.filter, b.filter)) return false;
  return !a.has_allowed_pairs || !b.has_allowed_pairs || !a.rare->allowed.contain(b.rare->allowed);
}

/// True if the object is a mesh without primitives.
inline bool is_bare_mesh(const ObjectInfo& info) { return info.mesh && info.primitives.empty(); }

/// A part of a scene that was declared solid, in world coordinates.
struct SolidPart {
  std::uint32_t part = 0;
  Aabb bounds;
  std::shared_ptr<const SolidMesh> solid;
};

/// A part of a scene that is solid by its winding number, in world coordinates.
struct WindingPart {
  std::uint32_t part = 0;
  Aabb bounds;
  std::shared_ptr<const WindingMesh> winding;
};

/// One loaded file's static triangles with their index, in world coordinates, and its objects' meshes with theirs.
struct StaticScene {
  std::string name;
  std::string source;  // how to load it again; for the loader, the world does not read it
  TriangleMesh mesh;
  Bvh tree;
  std::vector<Part> parts;                                          // ordered by first_triangle, without gap
  std::vector<ObjectId> part_objects;                               // one per part
  std::vector<std::shared_ptr<const IndexedMesh>> object_meshes;    // one per object of the file; null: without a mesh
  std::vector<std::shared_ptr<const SolidMesh>> object_solids;      // as object_meshes; null: not declared solid
  std::vector<SolidPart> solid_parts;                               // in the order of their parts
  std::vector<std::shared_ptr<const WindingMesh>> object_windings;  // as object_solids, for open meshes
  std::vector<WindingPart> winding_parts;                           // in the order of their parts
  std::vector<std::shared_ptr<const SceneLevel>> levels;            // simpler forms of the mesh, finest first
  std::vector<std::string> warnings;                                // about saved indexes that could not be used
  std::optional<TilesRead> tiles;                                   // for a file in tiles: what was read of it
  bool is_cut_off = false;                                          // only some triangles of some part are held

  /// The part that holds the triangle.
  std::uint32_t part_of(std::uint32_t triangle) const;
  /// Memory of index, mesh and parts.
  std::uint64_t bytes() const;
};

}  // namespace collided::engine
