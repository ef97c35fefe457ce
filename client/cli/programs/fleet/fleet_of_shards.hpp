#pragma once

#include "client/cli/session.hpp"

namespace collided::cli {

/// Prints the shards of the map of --shards, and who of them is there. Exit::no where one is not.
Exit print_shards(Session& session, const Globals& globals);

}  // namespace collided::cli
