#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>

#include "server/world/objects/object.hpp"

namespace collided::engine::service {

/// Numbers by which viewers ask for surfaces: one for each mesh, however many objects share it, and never reused. Keeps
/// no mesh alive.
///
/// threads  one
class SurfaceNumbers {
 public:
  /// The number of a mesh; a new one if the mesh has none yet.
  std::uint64_t number_of(const std::shared_ptr<const TriangleMesh>& mesh);
  /// The number of a scene's static triangles, all together.
  std::uint64_t number_of(const std::shared_ptr<const StaticScene>& scene);

  struct Found {
    std::shared_ptr<const TriangleMesh> mesh;  // null: it is gone, or the number was never given
    std::shared_ptr<const StaticScene> scene;  // of which the mesh is a part; null: the mesh is an object's
  };
  /// The mesh of a number.
  Found find(std::uint64_t number) const;

 private:
  struct Known {
    std::weak_ptr<const TriangleMesh> mesh;
    std::weak_ptr<const StaticScene> scene;
  };
  std::uint64_t number_of(const TriangleMesh* mesh, Known known);
  void forget_what_is_gone();

  std::unordered_map<const TriangleMesh*, std::uint64_t> numbers_;
  std::unordered_map<std::uint64_t, Known> known_;
  std::uint64_t newest_ = 0;
  std::size_t sweep_at_ = 256;  // entries at which the next sweep for expired meshes is due
};

}  // namespace collided::engine::service
