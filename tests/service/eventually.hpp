#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace collided::test {

/// Waits until `condition`, at most `most`; false when it never held.
inline bool eventually(const std::function<bool()>& condition,
                       std::chrono::milliseconds most = std::chrono::seconds(30)) {
  const auto give_up = std::chrono::steady_clock::now() + most;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > give_up) { return false; }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace collided::test
