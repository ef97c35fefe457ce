#pragma once

#include <chrono>
#include <cstdint>

namespace collided::wire_contract {

inline constexpr double kNanosecond_s = 1e-9;

/// Nanoseconds of a monotonic clock, for deadlines and periods.
inline std::int64_t steady_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Time since 1970 by the machine's clock, which may be adjusted.
inline std::chrono::nanoseconds since_1970() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch());
}
inline std::int64_t since_1970_ns() { return since_1970().count(); }

}  // namespace collided::wire_contract
