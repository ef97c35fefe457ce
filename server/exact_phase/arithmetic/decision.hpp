#pragma once

#include <cstdint>

namespace collided::engine {

/// Out of range, time or iterations is `undecided`, never `no`.
enum class Decision : std::uint8_t { no, yes, undecided };

/// The rung of the ladder that decided: double with an error bound, expansions or intervals, rationals.
enum class Level : std::uint8_t { filter, expansion, rational };

struct ExactResult {
  Decision decision = Decision::no;
  Level level = Level::filter;

  bool yes() const { return decision == Decision::yes; }
};

}  // namespace collided::engine
