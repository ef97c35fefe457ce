#pragma once

#include <chrono>
#include <thread>

#include "client/library/connection/server_pulse.hpp"

namespace collided::client {

/// Waits until condition() is true, calling it every millisecond; false if `deadline` comes first. For conditions that
/// DDS does not announce, such as the match of a reader.
template <class Condition>
bool wait_until(Clock::time_point deadline, Condition&& condition) {
  while (!condition()) {
    if (Clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace collided::client
