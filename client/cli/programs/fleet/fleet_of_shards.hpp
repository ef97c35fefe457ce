#pragma once

#include "client/cli/session.hpp"

namespace collided::cli {

/// Prints the shards of the map of --shards, and which of them are running. Exit::no if one is missing.
Exit print_shards(Session& session, const Globals& globals);

}  // namespace collided::cli
