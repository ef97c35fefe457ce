#pragma once

#include <memory>
#include <vector>

#include "server/geometry/pose.hpp"

namespace collided::bench {
using namespace engine;

struct ConvexCase {
  Primitive shape;  // about its own middle
  Pose pose;
};

/// Pairs of convex shapes in another library, made beforehand.
class ConvexPeer {
 public:
  virtual ~ConvexPeer() = default;
  virtual std::vector<bool> answers() = 0;
  virtual void collide(bool contacts) = 0;
};

std::unique_ptr<ConvexPeer> fcl_convex_peer(const std::vector<ConvexCase>& a, const std::vector<ConvexCase>& b);

}  // namespace collided::bench
