#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/intake/scene.hpp"
#include "server/intake/tiles/mesh_source.hpp"

namespace collided::engine {

/// How a mesh is cut into tiles, each triangle by its centroid.
struct TilingOptions {
  std::optional<double>
      size_m{};  // sides of the cubes; nothing: equally many triangles per tile, at most most_triangles
  std::size_t most_triangles = 65'536;
  std::function<void(double)> progress{};  // called with the fraction done, in [0, 1]
  std::function<bool()> cancelled{};       // called often; true ends the work with a LoadError
};

/// Results of writing.
struct TilingReport {
  std::size_t tiles = 0;
  std::uint64_t largest_triangles = 0;  // in the largest tile
  std::uint64_t bytes = 0;
};

/// Most triangles of one tile: that many are in memory at once.
inline constexpr std::uint64_t kMostTileTriangles = 2'000'000;

/// Writes a tile file (idl/tiles.fbs). The file gets its name only once it is complete. The same mesh and options give
/// the same bytes.
///
/// name      of the scene
/// source    name of the file that it was made of
/// parts     of the mesh, which cover its triangles in their order
/// cost      reads the triangles four times; 16 bytes per triangle of scratch space beside the file; far less memory
///           than the mesh takes
/// throws    LoadError: no triangle, too many tiles or too many triangles in one, the disk is full, or cancelled
TilingReport write_tiles(const std::string& path, const std::string& name, const std::string& source,
                         const std::vector<Part>& parts, MeshSource& mesh, const TilingOptions& options);

}  // namespace collided::engine
