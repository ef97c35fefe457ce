#pragma once

#include <cstdint>
#include <memory>
#include <unordered_map>

#include "server/world/objects/object.hpp"

namespace collided::engine::service {

/// Numbers by which viewers ask for surfaces: one a mesh, however many objects share it, never used again. Keeps no
/// mesh alive. One thread.
class SurfaceNumbers {
 public:
  std::uint64_t number_of(const std::shared_ptr<const TriangleMesh>& mesh);
  /// Of all of a scene's static triangles.
  std::uint64_t number_of(const std::shared_ptr<const StaticScene>& scene);

  struct Found {
    std::shared_ptr<const TriangleMesh> mesh;  // null: there is none any more
    std::shared_ptr<const StaticScene> scene;  // that the mesh is of; null: of an object
  };
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
  std::size_t sweep_at_ = 256;
};

}  // namespace collided::engine::service
