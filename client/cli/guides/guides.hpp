#pragma once

#include <span>
#include <string_view>

namespace collided::cli {

/// A guide of deploy/docs as a terminal of 80 columns shows it, embedded by client/cli/guides/embed.cmake.
struct Guide {
  std::string_view name;
  std::string_view text;
};

/// In the order in which README lists them.
std::span<const Guide> guides();

}  // namespace collided::cli
