#pragma once

#include <string>
#include <utility>
#include <vector>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// Pairs of links that an SRDF file lets touch (disable_collisions).
using LinkPairs = std::vector<std::pair<std::string, std::string>>;

/// file   as messages call it
LinkPairs read_srdf(const std::string& text, const std::string& file);

/// Filters by which the named objects meet each other and everything else but those pairs; pairs of names that are not
/// there are counted and left out. Each object gets a layer of its own, so there may be 31 at most.
/// returns   why there are none, or nothing
std::string allow_pairs(const LinkPairs& pairs, std::vector<SceneObject>& objects, std::uint64_t& unknown_count);

}  // namespace collided::engine
