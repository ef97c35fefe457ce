#pragma once

#include <cstdint>

namespace collided::engine {

/// Whether one of two objects lies wholly within the other, without meeting its surface.
enum class Contained : std::uint8_t { none, a_in_b, b_in_a };

/// The same with the two named the other way round.
inline Contained turned_round(Contained which) {
  if (which == Contained::none) return which;
  return which == Contained::a_in_b ? Contained::b_in_a : Contained::a_in_b;
}

}  // namespace collided::engine
