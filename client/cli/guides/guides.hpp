#pragma once

#include <span>
#include <string_view>

namespace collided::cli {

/// A guide of deploy/docs, embedded by client/cli/guides/embed.cmake: `collide help NAME` and collided-NAME(7).
struct Guide {
  std::string_view name;
  std::string_view markdown;
};

/// In the order in which README lists them.
std::span<const Guide> guides();

/// Null for any other name.
const Guide* find_guide(std::string_view name);

}  // namespace collided::cli
