#pragma once

#include <chrono>

#include "collided/client.hpp"

namespace collided::client {

/// A turn among the programs of this machine that are about to find a server of one domain. Each that joins is told of by
/// DDS to all that have joined, several times over, and fifty that join at once leave no time for the server to answer
/// any of them. So a few join at a time, and the others wait without having joined. One that has died gives its turn back.
///
/// Nothing depends on it but how soon a server is found: who has waited long enough joins without a turn, and so does
/// whoever asks a server of another machine. Any program of the machine can keep others waiting for so long.
///
/// threads  any
class GreetingTurn {
 public:
  /// Waits for a turn: for options.wait at most, without options.wait_is_limit on a crowded machine (see
  /// is_machine_crowded()) longer.
  explicit GreetingTurn(const ConnectOptions& options);
  ~GreetingTurn();
  GreetingTurn(const GreetingTurn&) = delete;
  GreetingTurn& operator=(const GreetingTurn&) = delete;

  /// How many have a turn at a time.
  static unsigned count();
  /// Whether this one got a turn.
  bool is_taken() const { return socket_ >= 0; }

 private:
  int socket_ = -1;  // whose name is the turn: the system takes it back from whoever ends
};

}  // namespace collided::client
