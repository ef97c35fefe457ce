#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Sends one command and puts the text of its answer together. A word of progress starts the timeout anew.
Result<std::string> command(Connection& connection, std::string_view name, std::string_view json_arguments,
                            const Shape& shape, std::chrono::nanoseconds timeout,
                            const std::function<void(double)>& progress);
/// The same, its arguments checked: a text that is not UTF-8 is bad input, since with its bytes replaced it would be another
/// object's name.
Result<std::string> command(Connection& connection, std::string_view name, const nlohmann::json& arguments,
                            std::chrono::nanoseconds timeout);
/// The same with bytes as they are, up to what a message holds beside its text.
Result<std::string> command_with_blob(Connection& connection, std::string_view name, std::string_view json_arguments,
                                      std::span<const std::uint8_t> blob, std::chrono::nanoseconds timeout,
                                      const std::function<void(double)>& progress);

}  // namespace collided::client
