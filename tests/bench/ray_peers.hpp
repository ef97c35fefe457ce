#pragma once

#include <cstdint>
#include <memory>

#include "server/geometry/mesh.hpp"
#include "server/geometry/ray.hpp"

namespace collided::bench {

/// A library that decides as exactly as we do.
class ExactRayPeer {
 public:
  virtual ~ExactRayPeer() = default;
  /// The nearest triangle, 0xffffffff for none.
  virtual std::uint32_t nearest(const Ray& ray) const = 0;
};

/// CGAL's tree of boxes with exact predicates.
std::unique_ptr<ExactRayPeer> cgal_ray_peer(const TriangleMesh& mesh);

}  // namespace collided::bench
