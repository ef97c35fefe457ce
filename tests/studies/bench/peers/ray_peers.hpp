#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "server/geometry/mesh.hpp"
#include "server/geometry/ray.hpp"

namespace collided::bench {
using namespace engine;

/// Another library's closest hit of a ray without end.
class RayPeer {
 public:
  virtual ~RayPeer() = default;
  virtual std::string name() const = 0;
  /// The nearest triangle, 0xffffffff for none.
  virtual std::uint32_t nearest(const Ray& ray) = 0;
};

/// CGAL's tree of boxes with exact predicates.
std::unique_ptr<RayPeer> cgal_ray_peer(const TriangleMesh& mesh);
std::unique_ptr<RayPeer> bullet_ray_peer(const TriangleMesh& mesh);
std::unique_ptr<RayPeer> ode_ray_peer(const TriangleMesh& mesh);

/// What they want instead of no end: more than any ray of the benchmark has to go. The camera is less than twice the
/// mesh's size away.
double beyond(const TriangleMesh& mesh);

}  // namespace collided::bench
