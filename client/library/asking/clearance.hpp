#pragma once

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Client::clearance: sends the command `clearance` and reads its answer.
Result<ClearanceAnswer> clearance(Connection& connection, const std::string& from, const ClearanceOptions& options);

}  // namespace collided::client
