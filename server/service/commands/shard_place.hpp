#pragma once

#include <string>

#include "server/geometry/aabb.hpp"

namespace collided::engine::service {

/// What this server holds of a world that several servers share.
struct ShardPlace {
  std::string name;
  Aabb held;  // it has everything that comes into this box
};

}  // namespace collided::engine::service
