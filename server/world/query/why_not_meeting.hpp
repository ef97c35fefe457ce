#pragma once

#include <string>
#include <vector>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

/// The reasons why no contact of the two is ever reported even if they touch, a sentence each; empty if it would be.
/// threads  any
std::vector<std::string> why_not_meeting(const Snapshot& snapshot, ObjectId a, ObjectId b);

}  // namespace collided::engine
