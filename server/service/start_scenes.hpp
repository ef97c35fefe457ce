#pragma once

#include <cstdint>
#include <string_view>

#include "server/service/options/options.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// Loads the scenes of the command line and the file into a world, or the embedded one where there are none, and prints
/// what it did: progress on a terminal, then a report. Throws LoadError or StartError.
void load_start_scenes(const Options& options, World& world, std::int64_t now_ns);

/// For who started a server without a scene, to look around.
std::string_view how_to_ask();

}  // namespace collided::engine::service
