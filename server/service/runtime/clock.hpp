#pragma once

#include <chrono>
#include <cstdint>

namespace collided::engine::service {

/// Nanoseconds of a clock that never goes back; deadlines and periods are measured with it.
inline std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// The server's clock of world time: nanoseconds since 1970 as the machine had them when the server started, then
/// steadily on, even if the machine's clock is set.
class WorldClock {
 public:
  std::int64_t now_ns() const { return steady_ns() + offset_ns_; }

 private:
  std::int64_t offset_ns_ =
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
          .count() -
      steady_ns();
};

}  // namespace collided::engine::service
