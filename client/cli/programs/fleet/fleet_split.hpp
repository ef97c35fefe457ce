#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "client/cli/session.hpp"

namespace collided::cli {

/// The options of `fleet split`.
struct FleetSplitOptions {
  std::string to;                                    // the next map: a file or an address
  std::optional<std::chrono::nanoseconds> patience;  // time limit for the new shards
  bool undo = false;
};

/// Splits a shard of the map of --shards, or reverts a split.
Exit split_shards(Session& session, const Globals& globals, const FleetSplitOptions& options);

}  // namespace collided::cli
