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
  std::string kept_in;         // the file; empty: none could be written, and the value is the clock's seconds
  std::string problem;         // why none could be written
  int rival_pid = 0;           // another process here serves the same domain and namespace; -1: its number is unknown
  std::shared_ptr<void> lock;  // on the domain and namespace; released with the last copy
  bool crashed = false;  // the server before this one did not end in order: publishers and watchers may be waiting
};

/// The next epoch: greater than the last one and at least the clock's seconds, so that it grows even if the file is
/// lost. It is written (beside the file, synced, renamed over it) before it is returned, so a crash repeats no epoch. A
/// lock beside the file is held until the Epoch or the process ends, however that is; on a busy machine a rival's
/// status may come too late.
///
/// state_dir    empty: $XDG_STATE_HOME/collided, ~/.local/state/collided, or /var/lib/collided for root
/// environment  the value of a variable, or null
Epoch next_epoch(const std::string& state_dir, int domain, const std::string& name_space,
                 const std::function<const char*(const char*)>& environment);

/// Writes down that this server ends in order.
void close_epoch(const Epoch& epoch);

}  // namespace collided::engine::service
