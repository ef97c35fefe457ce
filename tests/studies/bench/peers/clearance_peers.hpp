#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"

namespace collided::bench {
using namespace engine;

/// Another library that finds the least distance of some moved meshes to some that rest.
class ClearancePeer {
 public:
  virtual ~ClearancePeer() = default;
  virtual std::string name() const = 0;
  virtual double distance_m(std::span<const Pose> poses) = 0;
};

std::unique_ptr<ClearancePeer> fcl_clearance_peer(const std::vector<TriangleMesh>& links,
                                                  const std::vector<TriangleMesh>& cell);

}  // namespace collided::bench
