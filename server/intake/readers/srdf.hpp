#pragma once

#include <string>
#include <utility>
#include <vector>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// Pairs of links that may touch, from the disable_collisions elements of an SRDF file.
using LinkPairs = std::vector<std::pair<std::string, std::string>>;

/// Reads the pairs, or throws a LoadError.
/// file   its name in messages
LinkPairs read_srdf(const std::string& text, const std::string& file);

/// Sets the objects' filters so that contacts of those pairs are ignored, and no others. Pairs with a name that no
/// object has are counted and left out. Each object gets a layer of its own, so there may be 31 at most.
/// returns   why it is not possible; empty: done
std::string allow_pairs(const LinkPairs& pairs, std::vector<SceneObject>& objects, std::uint64_t& unknown_count);

}  // namespace collided::engine
