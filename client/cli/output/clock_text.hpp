#pragma once

#include <chrono>
#include <string>

namespace collided::cli {

/// A world time as local time, "12:04:31.201"; as seconds if the world's clock does not count from 1970.
std::string clock_text(std::chrono::nanoseconds world_time);

inline double seconds_of(std::chrono::nanoseconds time) { return static_cast<double>(time.count()) / 1e9; }

}  // namespace collided::cli
