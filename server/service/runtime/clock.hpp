#pragma once

#include <cstdint>

#include "idl/clocks.hpp"

namespace collided::engine::service {

using wire_contract::steady_ns;

/// The server's clock of world time: nanoseconds since 1970 by the machine's clock at the server's start, then steady,
/// even if the machine's clock is set.
class WorldClock {
 public:
  std::int64_t now_ns() const { return steady_ns() + offset_ns_; }

 private:
  std::int64_t offset_ns_ = wire_contract::since_1970_ns() - steady_ns();
};

}  // namespace collided::engine::service
