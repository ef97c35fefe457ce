#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/service/commands/command_family.hpp"

namespace collided::engine::service {

/// The collaborators of the fleet's commands.
struct FleetCommands {
  std::uint64_t shard_map = 0;          // of a shard: fingerprint of the map that it began with
  std::int64_t replaced_within_ns = 0;  // of a shard: so long its place may be empty between it and a standby
  /// The name of the server that takes this one's place, by the name that was asked for, or any; throws BadCommand.
  std::function<std::string(const std::string&)> hand_over;
};

/// `shard`, `watching`, `succession` and `hand_over`.
std::unique_ptr<CommandFamily> shard_commands(CommandContext& context, FleetCommands fleet);

}  // namespace collided::engine::service
