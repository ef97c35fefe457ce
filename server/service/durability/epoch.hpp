#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace collided::engine::service {

/// How the server before this one ended, by its own record. unknown: there is no record, or it is damaged.
enum class PastEnd : std::uint8_t { unknown, stopped, running };

/// A number that grows with each start of a server of this domain and namespace, so that clients can tell an old
/// state from a new one.
struct Epoch {
  std::uint64_t value = 0;
  std::string kept_in;         // the file; the rest of the state is kept next to it; empty: there is no folder for it
  std::string problem;         // why the value was not written; it is then at least the clock's seconds
  std::string damage;          // what was found damaged, as a sentence; empty: nothing
  int rival_pid = 0;           // another process here serves the same domain and namespace; -1: its number is unknown
  std::shared_ptr<void> lock;  // on the domain and namespace; released with the last copy
  PastEnd past = PastEnd::unknown;  // running: publishers and watchers may be waiting
};

/// The clock's seconds: a lower bound on every new epoch.
std::uint64_t least_epoch_now();

/// The next epoch: greater than the last one and at least the clock's seconds, so that it grows even if both its files
/// are lost. Writes nothing but a lock next to the file, which is held until the Epoch or the process ends, by a crash
/// too; on a busy machine a rival's status may come too late.
///
/// state_dir    empty: $XDG_STATE_HOME/collided, ~/.local/state/collided, or /var/lib/collided for root
/// environment  the value of a variable, or null
Epoch next_epoch(const std::string& state_dir, int domain, const std::string& name_space,
                 const std::function<const char*(const char*)>& environment);

/// Records that the server of this epoch runs: in a file and its copy, each with a checksum, each written next to
/// itself, synced and renamed. After that a crash repeats no epoch. Sets problem on failure.
void open_epoch(Epoch& epoch);

/// Records that the server runs as that epoch from now on, which must be greater.
///
/// returns  why it cannot be written, and epoch is unchanged; empty: it was written
std::string raise_epoch(Epoch& epoch, std::uint64_t value);

/// Records that this server was stopped properly.
void close_epoch(const Epoch& epoch);

}  // namespace collided::engine::service
