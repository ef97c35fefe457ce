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

// The bytes of a tile file (idl/tiles.fbs) and their meaning.
namespace collided::engine {

/// Alignment of tiles, and length of the last record.
inline constexpr std::size_t kTileBlockBytes = 64;

/// Most tiles of a file: the table of contents is read whole.
inline constexpr std::size_t kMostTiles = 65'536;

/// A part of the whole mesh. Its triangles follow those of the part before.
struct TiledPart {
  std::string name;
  Filter filter{};
  CutTriangles cut{};
  Aabb bounds{};
  std::uint32_t first_triangle = 0;
  std::uint32_t triangle_count = 0;
  std::uint32_t tile_count = 0;  // tiles with triangles of it
};

/// An entry of a tile in the table of contents.
struct TileEntry {
  Aabb bounds{};
  std::uint64_t first_byte = 0;
  std::uint64_t byte_count = 0;
  std::uint32_t checksum = 0;  // CRC-32 of its bytes
  std::uint32_t vertex_count = 0;
  std::uint32_t triangle_count = 0;
  std::vector<std::uint32_t> parts{};  // parts with triangles here, ascending
};

/// The table of contents.
struct TileContents {
  std::string name;    // of the scene
  std::string source;  // the file from which it was made
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
  std::vector<TriangleCorners> corners;         // one each: indexes into vertex_numbers
};

/// The bounding box of the triangles of the TileMesh.
Aabb bounds_of(const TileMesh& tile);

std::vector<std::byte> encode_tile(const TileMesh& tile);
/// The table and the last record, as written at the end of a file.
///
/// first_byte  position of the table in the file
std::vector<std::byte> encode_table(const TileContents& table, std::uint64_t first_byte);

/// CRC-32, as stored in the table of contents.
std::uint32_t tile_checksum(std::span<const std::byte> bytes);

/// The table of contents of an untrusted tile file. Checks its checksum and structure, then its meaning: names that are
/// valid and unique, parts and tiles that have as many triangles as the mesh, valid boxes, and tiles that follow each
/// other in the file.
///
/// throws  Flaw (scene_decoder.hpp)
TileContents decode_table(std::span<const std::byte> file);

/// A tile's triangles. Checks that the bytes are those with which the table of contents was made, and then that every
/// number is in its range and order, every vertex in the tile's box and every triangle one of the tile's parts.
///
/// tile    its index in the table
/// throws  Flaw
TileMesh decode_tile(std::span<const std::byte> file, const TileContents& table, std::size_t tile);

}  // namespace collided::engine
