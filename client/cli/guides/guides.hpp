#pragma once

#include <span>
#include <string_view>

namespace collided::cli {

/// A guide of deploy/docs, laid out for a terminal of 80 columns, embedded by client/cli/guides/embed.cmake.
struct Guide {
  std::string_view name;
  std::string_view text;
};

/// In the order of the README's list.
std::span<const Guide> guides();

}  // namespace collided::cli
