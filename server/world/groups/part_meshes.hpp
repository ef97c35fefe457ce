#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// The parts of static scenes as objects of their own, for searches over groups of objects: their bounds, and mesh and
/// index of those examined. A scene stores them only as runs of one mesh. They are built on demand and kept for later
/// requests while the scene is loaded and there is room.
///
/// threads  any; what two need at the same time may be built twice
class PartMeshes {
 public:
  static constexpr std::size_t kMostTriangles = std::size_t{4} << 20;  // kept, over all parts; about 0.5 GB

  /// By number of the part; empty for a part without triangles.
  /// cost  a pass over the scene's triangles, the first time
  std::shared_ptr<const std::vector<Aabb>> bounds_of(const std::shared_ptr<const StaticScene>& scene);

  /// The part in world coordinates.
  ///
  /// cancelled  called now and then; true leaves the mesh incomplete, and nothing is kept
  /// cost       indexes the part on the calling thread, the first time
  std::shared_ptr<const IndexedMesh> mesh_of(const std::shared_ptr<const StaticScene>& scene, std::uint32_t part,
                                             const std::function<bool()>& cancelled);

 private:
  struct SceneParts {
    std::weak_ptr<const StaticScene> scene;
    std::shared_ptr<const std::vector<Aabb>> bounds;
    std::map<std::uint32_t, std::shared_ptr<const IndexedMesh>> meshes;
  };

  SceneParts& parts_of_scene(const std::shared_ptr<const StaticScene>& scene);
  void make_room(std::size_t triangles);

  std::mutex mutex_;
  std::map<const StaticScene*, SceneParts> scenes_;
};

}  // namespace collided::engine
