#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "collided/client.hpp"

/// What a shard holds, as it says itself. A refusal alone may have other reasons than that something is not there.
namespace collided::client {

/// Whether it has an object of that name; nothing: it does not say.
std::optional<bool> has_object(Client& shard, const std::string& name);

/// How many objects it has of a group: an object, a scene or a glob. At least those; nothing: it does not say.
std::optional<std::uint64_t> count_of_group(Client& shard, const std::string& group);

}  // namespace collided::client
