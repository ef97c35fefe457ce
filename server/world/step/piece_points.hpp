#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <unordered_map>
#include <vector>

#include "server/world/objects/object.hpp"

namespace collided::engine {

/// Points that decide which parts of an object lie in a solid, kept from step to step: finding them visits the whole
/// mesh.
/// threads  one
class PiecePoints {
 public:
  /// Same as points_of_pieces(); valid until the next call.
  std::span<const Vec3> of(const ObjectInfo& info);
  /// Points of a part of a scene, with its bounds, in world coordinates; valid until the next call.
  struct PartPoints {
    std::vector<Vec3> points;
    Aabb bounds;
  };
  const PartPoints& of(const StaticScene& scene, std::uint32_t part);

 private:
  struct MeshPoints {
    std::weak_ptr<const IndexedMesh> mesh;
    std::vector<Vec3> points;
  };

  void forget_gone();

  std::unordered_map<const IndexedMesh*, MeshPoints> meshes_;
  std::unordered_map<ObjectId, PartPoints> parts_;  // by the part's object, whose id is never used again
  std::vector<Vec3> primitives_;
};

}  // namespace collided::engine
