#pragma once

#include <chrono>
#include <thread>

#include "client/library/connection/server_pulse.hpp"

namespace collided::client {

/// Waits until condition() is true, calling it every millisecond; false where `deadline` comes first. For what DDS does
/// not announce, such as whether a reader is matched.
template <class Condition>
bool wait_until(Clock::time_point deadline, Condition&& condition) {
  while (!condition()) {
    if (Clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace collided::client
