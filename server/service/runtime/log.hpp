#pragma once

#include <memory>
#include <spdlog/fwd.h>
#include <string>

namespace collided::engine::service {

/// A logger on stderr, written through after each line.
///
/// level  trace, debug, info, warn, error or off
/// json   one JSON object a line (time in s since 1970, level, message) instead of plain text
std::shared_ptr<spdlog::logger> make_log(const std::string& level, bool json);

}  // namespace collided::engine::service
