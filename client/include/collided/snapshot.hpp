#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "collided/client.hpp"

/// The world of a server at one instant, as a file.
#pragma GCC visibility push(default)

namespace collided {

/// A snapshot of the world that was written to a file.
struct WrittenSnapshot {
  std::uint64_t version = 0;               // of the world's state
  std::chrono::nanoseconds world_time{0};  // of that state, since 1970, by the publishers' clocks
  std::uint64_t parts = 0;                 // of scenes
  std::uint64_t objects = 0;               // others
  std::uint64_t triangles = 0;             // of the parts
  std::uint64_t bytes = 0;                 // of the file
  std::vector<std::string> lacks;          // what the server had and the file has not, as "48 velocities"
};

/// Writes the newest state of the world as a scene file, which a server or an engine loads to answer as this server does now,
/// bit for bit. The file stands under its name only once it is complete; one that is there is replaced.
///
/// path      on this machine
/// progress  called with a fraction in [0, 1] after each piece, on the calling thread; false ends the work
/// errors    bad_input where the file cannot be written; refused where the server is recovering, the world takes more than
///           512 MiB, or progress() ended it
Result<WrittenSnapshot> write_snapshot(const ConnectOptions& options, const std::string& path,
                                       const std::function<bool(double)>& progress = {});

}  // namespace collided

#pragma GCC visibility pop
