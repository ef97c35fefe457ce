#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "client/cli/session.hpp"

namespace collided::cli {

/// The options of `fleet publish`.
struct FleetPublishOptions {
  std::string to;                         // address in etcd
  std::optional<std::uint64_t> revision;  // of the map there that it replaces
};

/// Writes the map of --shards to etcd.
Exit publish_map(Session& session, const Globals& globals, const FleetPublishOptions& options);

}  // namespace collided::cli
