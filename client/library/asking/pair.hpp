#pragma once

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Client::pair: sends the command `pair` and reads its answer.
Result<PairAnswer> pair(Connection& connection, const std::string& a, const std::string& b, const PairOptions& options);

}  // namespace collided::client
