#pragma once

#include <span>
#include <string>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "collided/fences.hpp"

namespace collided {

namespace client {

/// Client::add_fence, add_fences, remove_fences and fences.
Result<void> add_fence(Connection& connection, const Fence& fence);
Result<void> add_fences(Connection& connection, std::span<const Fence> fences);
Result<std::size_t> remove_fences(Connection& connection, const std::string& name);
Result<std::vector<ListedFence>> list_fences(Connection& connection, const std::string& name_glob);

}  // namespace client

}  // namespace collided
