#pragma once

#include <string>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "collided/nearest.hpp"

namespace collided {

namespace client {

/// Client::add_nearest, remove_nearest and nearest.
Result<void> add_nearest(Connection& connection, const NearestQuestion& nearest);
Result<std::size_t> remove_nearest(Connection& connection, const std::string& name);
Result<std::vector<ListedNearest>> list_nearest(Connection& connection, const std::string& name_glob);

}  // namespace client

}  // namespace collided
