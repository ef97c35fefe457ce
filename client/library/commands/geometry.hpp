#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// Client::shapes, by the commands shapes, surface and more.
Result<ShownObjects> shapes(Connection& connection, const ShapesOptions& options, const ShownObjects* earlier);

/// All pages of an answer; nothing where the server no longer has it.
///
/// progress  called with a fraction after each page; false ends it with `refused`
Result<std::optional<std::string>> fetch_pages(Connection& connection, const char* command_name,
                                               nlohmann::json arguments, std::chrono::nanoseconds timeout,
                                               const std::function<bool(double)>& progress = {});

/// The error for an answer that has a flaw.
Error unfit(const char* command, const std::string& flaw);

/// Client::poses, by the command poses.
Result<Poses> poses(Connection& connection, std::chrono::nanoseconds timeout);

}  // namespace collided::client
