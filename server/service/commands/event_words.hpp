#pragma once

#include "server/world/events/events.hpp"

namespace collided::engine::service {

/// As answers call it; empty for none.
constexpr const char* reason_word(EndReason reason) {
  constexpr const char* kWords[] = {"",           "separated",        "removed",         "publisher_lost",
                                    "teleported", "geometry_changed", "server_stopping", "server_restarted",
                                    "decided",    "crossed",          "fence_removed",   "allowed"};
  return kWords[static_cast<std::size_t>(reason)];
}

constexpr const char* doubt_word(Doubt doubt) {
  constexpr const char* kWords[] = {"", "numeric", "cost_limit", "publisher_lost"};
  return kWords[static_cast<std::size_t>(doubt)];
}

}  // namespace collided::engine::service
