#pragma once

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "collided/client.hpp"

namespace collided::testing_support {

using SteadyClock = std::chrono::steady_clock;

inline double ms_since(SteadyClock::time_point start) {
  return std::chrono::duration<double, std::milli>(SteadyClock::now() - start).count();
}

/// 0 of none.
inline double percentile(std::vector<double> values, double part) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<std::size_t>(part * static_cast<double>(values.size())))];
}

/// Ends the program with code 2 where there is none: nothing can be measured then.
template <class T>
T value_of(Result<T> result, const char* what) {
  if (!result) {
    std::fprintf(stderr, "%s: %s\n", what, result.error().message.c_str());
    std::exit(2);
  }
  if constexpr (!std::is_void_v<T>) return std::move(*result);
}

/// Looks every `pause` until the condition holds; false when it never did within `most`.
template <class Condition>
bool wait_until(Condition&& condition, std::chrono::milliseconds most,
                std::chrono::milliseconds pause = std::chrono::milliseconds(2)) {
  const auto until = SteadyClock::now() + most;
  while (!condition()) {
    if (SteadyClock::now() >= until) return false;
    std::this_thread::sleep_for(pause);
  }
  return true;
}

}  // namespace collided::testing_support
