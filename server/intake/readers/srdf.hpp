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

/// Numbers the scene's objects and allows those pairs, and no others, to touch. A pair with a name that no object has
/// is counted and left out.
/// returns   how many were left out
std::uint64_t allow_pairs(const LinkPairs& pairs, Scene& scene);

}  // namespace collided::engine
