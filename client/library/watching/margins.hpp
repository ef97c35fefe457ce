#pragma once

#include <string>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "collided/margins.hpp"

namespace collided {

namespace client {

/// Client::add_margin, remove_margins and margins.
Result<AddedMargin> add_margin(Connection& connection, const Margin& margin);
Result<std::size_t> remove_margins(Connection& connection, const std::string& name);
Result<std::vector<ListedMargin>> list_margins(Connection& connection, const std::string& name_glob);

}  // namespace client

}  // namespace collided
