#pragma once

#include <memory>
#include <string>

#include "server/exact_phase/solid/surface_crossing.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::bench {
using namespace engine;

/// Another library that tells where a point is relative to a closed mesh.
class SolidPeer {
 public:
  virtual ~SolidPeer() = default;
  virtual std::string name() const = 0;
  virtual SolidSide side(const Vec3& point) = 0;
};

std::unique_ptr<SolidPeer> cgal_solid_peer(const TriangleMesh& mesh);

}  // namespace collided::bench
