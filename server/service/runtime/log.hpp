#pragma once

#include <memory>
#include <spdlog/logger.h>
#include <string>

namespace collided::engine::service {

/// A logger on stderr: lines for people, or one JSON object a line.
std::shared_ptr<spdlog::logger> make_log(const std::string& level, bool json);

}  // namespace collided::engine::service
