#pragma once

#include "collided/codes.hpp"

namespace collided::engine {

using Contained = codes::Containment;

/// The same relation with the two objects exchanged.
inline Contained turned_round(Contained which) {
  if (which == Contained::none) return which;
  return which == Contained::a_in_b ? Contained::b_in_a : Contained::a_in_b;
}

}  // namespace collided::engine
