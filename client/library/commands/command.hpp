#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Client::command: sends one command and returns the whole text of its answer. A progress message restarts the
/// timeout. Any thread.
Result<std::string> command(Connection& connection, std::string_view name, std::string_view json_arguments,
                            const Shape& shape, std::chrono::nanoseconds timeout,
                            const std::function<void(double)>& progress);
/// Writes arguments with names as text. A name that is not UTF-8 is bad_input, since with replaced bytes it could be
/// another object's name.
Result<std::string> argument_text(std::string_view name, const nlohmann::json& arguments);
/// Sends a command with such arguments.
Result<std::string> command(Connection& connection, std::string_view name, const nlohmann::json& arguments,
                            std::chrono::nanoseconds timeout, const std::function<void(double)>& progress = {});
/// Sends a command with bytes, up to the room that its text leaves in a message.
Result<std::string> command_with_blob(Connection& connection, std::string_view name, std::string_view json_arguments,
                                      std::span<const std::uint8_t> blob, std::chrono::nanoseconds timeout,
                                      const std::function<void(double)>& progress);

}  // namespace collided::client
