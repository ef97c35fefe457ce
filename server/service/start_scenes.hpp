#pragma once

#include <cstdint>
#include <string_view>

#include "server/service/options/options.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// Loads the scenes that the options name into a world, or the embedded one if they name none. Prints its progress on a
/// terminal, then a report. Throws LoadError or StartError.
///
/// now_ns  world time of the step that makes them visible
void load_start_scenes(const Options& options, World& world, std::int64_t now_ns);

/// Suggestions for a user who started a server without a scene.
std::string_view how_to_ask();

}  // namespace collided::engine::service
