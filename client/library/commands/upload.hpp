#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Client::upload. Sends the pieces one after the other and waits for the server's confirmation of each; a lost or
/// damaged piece is sent again, up to three times.
Result<std::string> upload(Connection& connection, std::span<const std::byte> bytes, std::string_view file_name,
                           std::string_view json_arguments, std::chrono::nanoseconds timeout,
                           const std::function<void(double)>& progress);

}  // namespace collided::client
