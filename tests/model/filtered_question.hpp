#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "server/world/query/query.hpp"

namespace collided::model {
using namespace engine;

/// Like the product's globs, of the few patterns that are asked here: by themselves, a star at the end, a mark anywhere.
inline bool fits(std::string_view pattern, std::string_view name) {
  if (pattern.empty() || name.empty()) return pattern == name || pattern == "*";
  if (pattern[0] == '*') return fits(pattern.substr(1), name) || fits(pattern, name.substr(1));
  return (pattern[0] == '?' || pattern[0] == name[0]) && fits(pattern.substr(1), name.substr(1));
}

/// What a question of the twin test may leave out, and which of the hits it wants.
struct Filtered {
  std::uint32_t mask = 0xffffffff;
  std::string only, skip;
  HitMode mode = HitMode::closest;
  std::uint32_t max_hits = 1'000;
  double error_m = 0;

  bool allows(std::string_view name, std::uint32_t layers) const {
    return (layers & mask) != 0 && (only.empty() || fits(only, name)) && (skip.empty() || !fits(skip, name));
  }
};

}  // namespace collided::model
