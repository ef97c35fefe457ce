#pragma once

#include "server/world/query/query.hpp"

namespace collided::engine::service {

/// As answers call it.
constexpr const char* verdict_word(Verdict verdict) {
  constexpr const char* kWords[] = {"miss", "hit", "undecided", "invalid"};
  return kWords[static_cast<std::size_t>(verdict)];
}

}  // namespace collided::engine::service
