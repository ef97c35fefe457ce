#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace collided::view {

/// The value as text; bytes that are not UTF-8 become U+FFFD.
inline std::string text_of(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace collided::view
