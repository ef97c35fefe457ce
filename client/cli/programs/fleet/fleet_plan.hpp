#pragma once

#include <string>

#include "client/cli/session.hpp"

namespace collided::cli {

/// The options of `fleet plan`, as written.
struct FleetPlanOptions {
  std::string into;    // how many boxes
  std::string margin;  // of a new map
  std::string by;      // the measure of load
  std::string split;   // of the shards of --shards
  std::string out;     // file or address of the map
};

/// Proposes a shard map for the world of the server, or, with --shards, a split of one shard of that map.
Exit plan_shards(Session& session, const Globals& globals, const FleetPlanOptions& options);

}  // namespace collided::cli
