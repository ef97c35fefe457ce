#pragma once

#include <cstdlib>

namespace collided {

/// How many rounds a twin test runs: COLLIDED_TWIN_ROUNDS, or as many as its short form has.
inline int rounds_asked(int short_form) {
  const char* asked = std::getenv("COLLIDED_TWIN_ROUNDS");
  return asked != nullptr ? std::atoi(asked) : short_form;
}

}  // namespace collided
