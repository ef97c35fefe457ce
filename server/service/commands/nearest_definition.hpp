#pragma once

#include "server/service/commands/command_arguments.hpp"
#include "server/world/fences/fence.hpp"

namespace collided::engine::service {

/// The question for the nearest object that a command defines; throws BadCommand.
FenceDefinition nearest_of(const Arguments& arguments);

}  // namespace collided::engine::service
