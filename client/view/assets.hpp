#pragma once

#include <span>
#include <string_view>

namespace collided::view {

/// A file of the page, compiled into the program (embed.cmake writes the definition from page/).
struct Asset {
  std::string_view path;  // "/view.js"
  std::string_view type;  // for the Content-Type header
  std::string_view text;
};

std::span<const Asset> assets();

}  // namespace collided::view
