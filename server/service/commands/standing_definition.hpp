#pragma once

#include <cstddef>
#include <span>

#include "server/service/commands/command_arguments.hpp"
#include "server/world/fences/fence.hpp"

namespace collided::engine::service {

/// The standing question that a command defines; throws BadCommand.
///
/// shape_bytes  of a region: table Shape of scene.fbs; unused if there is a prism
FenceDefinition definition_of(const Arguments& arguments, std::span<const std::byte> shape_bytes);

}  // namespace collided::engine::service
