#pragma once

#include <nlohmann/json_fwd.hpp>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Client::pair: sends the command `pair` and reads its answer.
Result<PairAnswer> pair(Connection& connection, const std::string& a, const std::string& b, const PairOptions& options);

/// The answer of `pair`, or what `explain` has in common with it. Throws nlohmann::json::exception.
PairAnswer read_pair(const nlohmann::json& answer);

}  // namespace collided::client
