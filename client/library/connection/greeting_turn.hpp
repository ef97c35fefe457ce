#pragma once

#include <chrono>

#include "collided/client.hpp"

namespace collided::client {

/// A turn for joining a domain, among the programs of this machine. DDS announces every new participant to all others,
/// repeatedly, so fifty programs that join at once leave the server no time to answer any of them. Therefore a few join
/// at a time, and the others wait without having joined. A program that dies releases its turn.
///
/// It affects only how soon a server is found. A program that has waited long enough joins without a turn, and so does
/// one whose server is on another machine. Any program of the machine can delay others up to this time.
///
/// threads  any
class GreetingTurn {
 public:
  /// Waits for a turn, at most options.wait; longer on a crowded machine (is_machine_crowded()) without
  /// options.wait_is_limit.
  explicit GreetingTurn(const ConnectOptions& options);
  ~GreetingTurn();
  GreetingTurn(const GreetingTurn&) = delete;
  GreetingTurn& operator=(const GreetingTurn&) = delete;

  /// Number of simultaneous turns.
  static unsigned count();
  /// True if it got a turn.
  bool is_taken() const { return socket_ >= 0; }

 private:
  int socket_ = -1;  // its name is the turn, which the system frees when the process ends
};

}  // namespace collided::client
