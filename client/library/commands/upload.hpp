#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Client::upload. Pieces go one after the other, each until the server has it; one that was lost or damaged goes again.
Result<std::string> upload(Connection& connection, std::span<const std::byte> bytes, std::string_view file_name,
                           std::string_view json_arguments, std::chrono::nanoseconds timeout,
                           const std::function<void(double)>& progress);

}  // namespace collided::client
