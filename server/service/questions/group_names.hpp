#pragma once

#include <string>
#include <variant>
#include <vector>

#include "server/world/objects/snapshot.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// The objects of a state that a text names: the object of that name; else all objects of the scene of that name; else
/// those whose names match it as a glob.
///
/// what     begins the sentence of a refusal, such as "clearance"
/// skip     glob of names that are left out; empty: none
/// refused  if there is none, with the nearest names
std::variant<std::vector<ObjectId>, Refusal> objects_meant(const Snapshot& state, const std::string& what,
                                                           const std::string& text, const std::string& skip);

/// All objects of the state that are not in `those`, and whose names do not match the glob.
std::vector<ObjectId> all_others(const Snapshot& state, const std::vector<ObjectId>& those, const std::string& skip);

}  // namespace collided::engine::service
