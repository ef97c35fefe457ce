#pragma once

#include <string_view>

#include "client/cli/session.hpp"

namespace collided::cli {

/// Warns of each missing shard of --shards, with the consequence for the verb.
void warn_of_shards_away(Session& session, const Globals& globals, std::string_view meaning);

}  // namespace collided::cli
