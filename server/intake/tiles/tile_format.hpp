#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/shape.hpp"
#include "server/intake/scene.hpp"

// The bytes of a tile file (idl/tiles.fbs) and what they say.
namespace collided::engine {

/// Where a tile begins, and how long the last record is.
inline constexpr std::size_t kTileBlockBytes = 64;

/// Tiles of a file at most: the table of contents is read whole.
inline constexpr std::size_t kMostTiles = 65'536;

/// A part of the whole mesh. Its triangles follow those of the part before.
struct TiledPart {
  std::string name;
  Filter filter{};
  CutTriangles cut{};
  Aabb bounds{};
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  std::uint32_t tile_count = 0;  // that have triangles of it
};

/// What the table of contents says of a tile.
struct TileEntry {
  Aabb bounds{};
  std::uint64_t first_byte = 0;
  std::uint64_t byte_count = 0;
  std::uint32_t checksum = 0;  // CRC-32 of its bytes
  std::uint32_t vertex_count = 0;
  std::uint32_t triangle_count = 0;
  std::vector<std::uint32_t> parts{};  // that have triangles here, ascending
};

/// The table of contents.
struct TileContents {
  std::string name;    // of the scene
  std::string source;  // the file that it was made of
  std::uint32_t vertex_count = 0;
  std::uint32_t triangle_count = 0;
  std::vector<TiledPart> parts{};
  std::vector<TileEntry> tiles{};
};

/// The triangles of one tile, by numbers of the whole mesh.
struct TileMesh {
  std::vector<std::uint32_t> vertex_numbers;    // ascending
  std::vector<Vec3> vertices;                   // one each
  std::vector<std::uint32_t> triangle_numbers;  // ascending
  std::vector<TriangleCorners> corners;         // one each: places in vertex_numbers
};

/// The triangles of the TileMesh as a box.
Aabb bounds_of(const TileMesh& tile);

std::vector<std::byte> encode_tile(const TileMesh& tile);
/// The table and the last record, as they stand at the end of a file.
///
/// first_byte  of the table in the file
std::vector<std::byte> encode_table(const TileContents& table, std::uint64_t first_byte);

/// CRC-32, as the table of contents holds it.
std::uint32_t tile_checksum(std::span<const std::byte> bytes);

/// The table of contents of a tile file, from anyone. Checked are its checksum and structure, then its meaning: names that
/// are valid and unique, parts and tiles that have as many triangles as the mesh, boxes that are boxes, tiles that follow each
/// other in the file.
///
/// throws  Flaw (scene_decoder.hpp)
TileContents decode_table(std::span<const std::byte> file);

/// A tile's triangles. Checked is that the bytes are those that the table of contents was made with, and then that every
/// number is in its range and order, every vertex in the tile's box and every triangle one of the tile's parts.
///
/// tile    its place in the table
/// throws  Flaw
TileMesh decode_tile(std::span<const std::byte> file, const TileContents& table, std::size_t tile);

}  // namespace collided::engine
