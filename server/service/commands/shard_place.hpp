#pragma once

#include <string>

#include "server/geometry/aabb.hpp"

namespace collided::engine::service {

/// The part that this server holds of a world shared by several servers.
struct ShardPlace {
  std::string name;
  Aabb held;  // it has everything that comes into this box
};

}  // namespace collided::engine::service
