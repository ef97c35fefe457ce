#pragma once

#include <string>
#include <vector>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

/// Why no contact of the two is ever told although they might touch, a sentence each; none: it would be told.
/// threads  any
std::vector<std::string> why_not_meeting(const Snapshot& snapshot, ObjectId a, ObjectId b);

}  // namespace collided::engine
