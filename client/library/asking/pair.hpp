#pragma once

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// The command `pair` and what its answer says.
Result<PairAnswer> pair(Connection& connection, const std::string& a, const std::string& b, const PairOptions& options);

}  // namespace collided::client
