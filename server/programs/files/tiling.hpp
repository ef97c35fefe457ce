#pragma once

#include <string>

#include "server/intake/scene.hpp"
#include "server/intake/tiles/tile_writer.hpp"
#include "server/programs/files/file_options.hpp"

namespace collided::engine::files {

/// The value of --tiles: a length, such as "100m", or "auto". Throws LoadError.
TilingOptions tiling_of(const std::string& text);

/// Writes the scene's mesh as a tile file and prints what was written. Throws LoadError or Interrupted.
void write_in_tiles(const std::string& path, const std::string& source, const Scene& scene, const std::string& tiles);

/// The same for a file that can be read in pieces, with far less memory than its mesh takes. False: it cannot, and
/// nothing was done.
bool stream_into_tiles(const std::string& path, const FileOptions& file, const std::string& tiles, LoadReport& report);

}  // namespace collided::engine::files
