#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Client::command: sends one command and returns the whole text of its answer. A message of progress starts the
/// timeout anew. Any thread.
Result<std::string> command(Connection& connection, std::string_view name, std::string_view json_arguments,
                            const Shape& shape, std::chrono::nanoseconds timeout,
                            const std::function<void(double)>& progress);
/// Arguments with names as text: one that is not UTF-8 is bad_input, since replacing its bytes could make it another
/// object's name.
Result<std::string> argument_text(std::string_view name, const nlohmann::json& arguments);
/// The same with such arguments.
Result<std::string> command(Connection& connection, std::string_view name, const nlohmann::json& arguments,
                            std::chrono::nanoseconds timeout, const std::function<void(double)>& progress = {});
/// The same with bytes, up to what a message can hold beside its text.
Result<std::string> command_with_blob(Connection& connection, std::string_view name, std::string_view json_arguments,
                                      std::span<const std::uint8_t> blob, std::chrono::nanoseconds timeout,
                                      const std::function<void(double)>& progress);

}  // namespace collided::client
