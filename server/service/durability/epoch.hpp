#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace collided::engine::service {

/// A number that grows with each start of a server of this domain and namespace, so that clients can tell an old
/// state from a new one.
struct Epoch {
  std::uint64_t value = 0;
  std::string kept_in;  // the file; empty: nowhere could be written, and the value is the clock's seconds
  std::string problem;  // why nowhere
  int rival_pid = 0;    // another process of this machine serves the same domain and namespace; then all else is empty
  std::shared_ptr<void> lock;  // released with the last copy
  bool crashed = false;  // the server before this one did not end in order: its publishers and watchers may be waiting
};

/// One more than the last one, and at least the clock's seconds, so that it grows over a lost file as well. Written
/// (beside the file, synced, renamed over it) before it is returned: a crash repeats no epoch. Takes a lock beside the
/// file that goes with the Epoch or the process, however that ends: on a busy machine a rival's status may come too late.
///
/// state_dir   empty: $XDG_STATE_HOME/collided, ~/.local/state/collided, or /var/lib/collided for root
Epoch next_epoch(const std::string& state_dir, int domain, const std::string& name_space,
                 const std::function<const char*(const char*)>& environment);

/// Says that this server ends in order.
void close_epoch(const Epoch& epoch);

}  // namespace collided::engine::service
