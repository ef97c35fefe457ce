#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "client/library/connection.hpp"

namespace collided::client {

/// Sends one command and puts the text of its answer together. A word of progress starts the timeout anew.
Result<std::string> command(Connection& connection, std::string_view name, std::string_view json_arguments,
                            const Shape& shape, std::chrono::nanoseconds timeout,
                            const std::function<void(double)>& progress);

}  // namespace collided::client
