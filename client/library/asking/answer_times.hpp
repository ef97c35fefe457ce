#pragma once

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>

#include "client/library/connection/errors.hpp"
#include "collided/questions.hpp"

namespace collided::client {

/// The time that the server may work on an answer, from its receipt of the question. Without a deadline: slightly
/// longer than the timeout, after which no call waits. The call then reports the timeout, not an undecided answer.
inline std::chrono::nanoseconds server_deadline(std::chrono::nanoseconds deadline, std::chrono::nanoseconds timeout) {
  constexpr std::chrono::nanoseconds kLongest = std::chrono::hours{24};
  if (deadline.count() > 0) return deadline;
  return std::clamp(timeout, std::chrono::nanoseconds(0), kLongest) + std::chrono::milliseconds(100);
}

/// Why the times of a question are invalid; nothing: they are valid.
inline std::optional<Error> time_fault(const std::string& what, const Instant& as_of,
                                       std::chrono::nanoseconds deadline) {
  if (as_of.time.count() < 0) {
    return bad_input(what + ": the instant is " + std::to_string(as_of.time.count()) + " ns; allowed 0 or more");
  }
  if (deadline.count() < 0) {
    return bad_input(what + ": the deadline is " + std::to_string(deadline.count()) + " ns; allowed 0 (none) and more");
  }
  return std::nullopt;
}

}  // namespace collided::client
