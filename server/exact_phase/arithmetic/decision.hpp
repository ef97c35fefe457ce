#pragma once

#include <cstdint>

namespace collided::engine {

/// The answer of an exact test. A test that runs out of range, time or iterations is `undecided`, never `no`.
enum class Decision : std::uint8_t { no, yes, undecided };

/// Which rung of the arithmetic decided: double with an error bound, expansions or scaled numbers, rationals.
enum class Level : std::uint8_t { filter, expansion, rational };

/// A decision and the rung that it needed.
struct ExactResult {
  Decision decision = Decision::no;
  Level level = Level::filter;

  bool yes() const { return decision == Decision::yes; }
};

}  // namespace collided::engine
