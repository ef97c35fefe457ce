#include "server/intake/tiles/tile_format.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <string_view>
#include <unordered_set>

#include "idl/scene_tables.hpp"
#include "idl/tiles_generated.h"
#include "server/intake/readers/names.hpp"
#include "server/intake/readers/reading.hpp"
#include "server/intake/scene_file/scene_decoder.hpp"
#include "server/intake/scene_file/scene_encoder.hpp"

namespace collided::engine {
namespace {

constexpr char kMagic[8] = {'C', 'T', 'I', 'L', 'E', 'S', '0', '1'};
constexpr std::uint32_t kByteOrder = 0x01020304;
constexpr std::uint32_t kTileFormat = 1;

/// The last bytes of the file.
struct TileFileEnd {
  std::uint64_t table_first_byte = 0;
  std::uint64_t table_bytes = 0;
  std::uint32_t checksum = 0;  // of the table
  std::uint32_t byte_order = kByteOrder;
  std::uint8_t spare[32] = {};
  char magic[8] = {};
};
static_assert(sizeof(TileFileEnd) == kTileBlockBytes);
static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(TriangleCorners) == 3 * sizeof(std::uint32_t));

std::span<const std::byte> table_of(std::span<const std::byte> file) {
  TileFileEnd last;
  if (file.size() < sizeof last)
    throw Flaw{fmt::format("{} bytes, a tile file has at least {}", file.size(), sizeof last)};
  std::memcpy(&last, file.data() + file.size() - sizeof last, sizeof last);
  if (std::memcmp(last.magic, kMagic, sizeof kMagic) != 0 || last.byte_order != kByteOrder) {
    throw Flaw{fmt::format("no tile file, or cut short: its {} bytes do not end as one does", file.size())};
  }
  const std::uint64_t before_last = file.size() - sizeof last;
  if (last.table_first_byte > before_last || last.table_bytes != before_last - last.table_first_byte) {
    throw Flaw{fmt::format("cut or damaged: a table of contents of {} bytes from {} on does not fit {} bytes",
                           last.table_bytes, last.table_first_byte, file.size())};
  }
  const auto table = file.subspan(last.table_first_byte, last.table_bytes);
  if (tile_checksum(table) != last.checksum) {
    throw Flaw{fmt::format("damaged: the checksum of its table of contents is {:08x}, it should be {:08x}",
                           tile_checksum(table), last.checksum)};
  }
  return table;
}

Vec3 point_of(const format::Vec3* from) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  return from == nullptr ? Vec3::Constant(kNone) : Vec3(from->x(), from->y(), from->z());
}

template <class Table>
Aabb box_of(const Table& from, const std::string& what) {
  const Aabb box{.low = point_of(from.low()), .high = point_of(from.high())};
  if (!box.low.allFinite() || !box.high.allFinite() || box.empty()) throw Flaw{what + " has no box"};
  return box;
}

/// Ascending numbers below a limit.
void check_ascending(std::span<const std::uint32_t> numbers, std::uint64_t limit, std::string_view what) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] >= limit || (i > 0 && numbers[i] <= numbers[i - 1]))
      throw Flaw{fmt::format("{} {} is {}, they must ascend below {}", what, i, numbers[i], limit)};
  }
}

/// Reads the tables of contents, none of which may grow beyond the bytes from which it is read: tables may share their
/// numbers.
class TableDecoder {
 public:
  explicit TableDecoder(std::uint64_t byte_count) : byte_budget_(byte_count) {}

  TileContents decode(const format::TileTable& from, std::uint64_t tile_bytes) {
    if (from.format() < 1 || from.format() > kTileFormat)
      throw Flaw{fmt::format("tile format {}, this program reads up to {}", from.format(), kTileFormat)};
    TileContents table{.name = named(*from.name(), "scene"),
                       .source = from.source() == nullptr ? std::string() : mended_name(from.source()->string_view()),
                       .vertex_count = from.vertex_count(),
                       .triangle_count = from.triangle_count()};
    add_parts(from, table);
    add_tiles(from, tile_bytes, table);
    return table;
  }

 private:
  void spend(std::uint64_t bytes) {
    if (bytes > byte_budget_) throw Flaw{"tables share their numbers, so that it would grow beyond its own size"};
    byte_budget_ -= bytes;
  }
  std::string named(const flatbuffers::String& name, std::string_view what) {
    spend(name.size());
    if (const std::string flaw = flaw_of_name(name.string_view()); !flaw.empty())
      throw Flaw{fmt::format("{} name {} {}", what, in_quotes(name.string_view()), flaw)};
    return name.str();
  }

  void add_parts(const format::TileTable& from, TileContents& table) {
    std::unordered_set<std::string> names;
    std::uint64_t triangles = 0;
    for (const format::TilePart* part : *from.parts()) {
      TiledPart& to = table.parts.emplace_back();
      to.name = named(*part->name(), "part");
      if (!names.insert(to.name).second)
        throw Flaw{fmt::format("two parts have the name {}", in_quotes(std::string_view(to.name)))};
      to.filter = filter_of(part->filter());
      to.bounds = box_of(*part, "part " + to.name);
      to.first_triangle = static_cast<std::uint32_t>(triangles);
      to.triangle_count = part->triangle_count();
      to.tile_count = part->tile_count();
      spend(part->piece_of() == nullptr ? 0 : std::uint64_t{part->piece_of()->size()} * sizeof(std::uint32_t));
      to.cut = cut_of(*part, "part", to.triangle_count);
      triangles += to.triangle_count;
      if (to.triangle_count == 0 || triangles > table.triangle_count)
        throw Flaw{fmt::format("part {} brings the triangles to {} of {}", to.name, triangles, table.triangle_count)};
    }
    if (triangles != table.triangle_count)
      throw Flaw{fmt::format("parts have {} of {} triangles", triangles, table.triangle_count)};
  }

  void add_tiles(const format::TileTable& from, std::uint64_t tile_bytes, TileContents& table) {
    if (from.tiles()->size() > kMostTiles)
      throw Flaw{fmt::format("{} tiles, limit {}", from.tiles()->size(), kMostTiles)};
    std::uint64_t triangles = 0;
    std::uint64_t taken_bytes = 0;
    std::vector<std::uint32_t> tiles_of_part(table.parts.size());
    for (const format::Tile* tile : *from.tiles()) {
      const std::string what = fmt::format("tile {}", table.tiles.size());
      spend(std::uint64_t{tile->parts()->size()} * sizeof(std::uint32_t));
      TileEntry& to = table.tiles.emplace_back(TileEntry{.bounds = box_of(*tile, what),
                                                         .first_byte = tile->first_byte(),
                                                         .byte_count = tile->byte_count(),
                                                         .checksum = tile->checksum(),
                                                         .vertex_count = tile->vertex_count(),
                                                         .triangle_count = tile->triangle_count(),
                                                         .parts = format::copied<std::uint32_t>(tile->parts())});
      if (to.first_byte < taken_bytes || to.first_byte > tile_bytes || to.byte_count > tile_bytes - to.first_byte)
        throw Flaw{fmt::format("{} is {} bytes from {} on, allowed are those from {} to {}", what, to.byte_count,
                               to.first_byte, taken_bytes, tile_bytes)};
      taken_bytes = to.first_byte + to.byte_count;
      triangles += to.triangle_count;
      check_ascending(to.parts, table.parts.size(), what + ": part");
      for (const std::uint32_t part : to.parts) ++tiles_of_part[part];
    }
    if (triangles != table.triangle_count)
      throw Flaw{fmt::format("tiles have {} of {} triangles", triangles, table.triangle_count)};
    for (std::size_t part = 0; part < table.parts.size(); ++part) {
      if (tiles_of_part[part] != table.parts[part].tile_count)
        throw Flaw{fmt::format("part {} is in {} tiles, it should be in {}", table.parts[part].name,
                               tiles_of_part[part], table.parts[part].tile_count)};
    }
  }

  std::uint64_t byte_budget_;
};

/// Every triangle is of one of the tile's parts.
void check_parts(const TileMesh& mesh, const TileContents& table, const TileEntry& entry) {
  auto part = entry.parts.begin();
  for (const std::uint32_t number : mesh.triangle_numbers) {
    const auto is_past = [&] {
      return number >= table.parts[*part].first_triangle &&
             number - table.parts[*part].first_triangle >= table.parts[*part].triangle_count;
    };
    while (part != entry.parts.end() && is_past()) ++part;
    if (part == entry.parts.end() || number < table.parts[*part].first_triangle)
      throw Flaw{fmt::format("triangle {} is of none of its parts", number)};
  }
}

TileMesh checked(const format::TileMesh& from, const TileContents& table, const TileEntry& entry) {
  TileMesh mesh;
  mesh.vertex_numbers = format::copied<std::uint32_t>(from.vertex_numbers());
  mesh.triangle_numbers = format::copied<std::uint32_t>(from.triangle_numbers());
  const std::size_t vertex_count = mesh.vertex_numbers.size();
  const std::size_t triangle_count = mesh.triangle_numbers.size();
  if (vertex_count != entry.vertex_count || triangle_count != entry.triangle_count ||
      from.vertices()->size() != 3 * vertex_count || from.corners()->size() != 3 * triangle_count) {
    throw Flaw{fmt::format("{} vertices and {} triangles, it should have {} and {}", vertex_count, triangle_count,
                           entry.vertex_count, entry.triangle_count)};
  }
  mesh.vertices = format::copied<Vec3>(from.vertices());
  mesh.corners = format::copied<TriangleCorners>(from.corners());
  check_ascending(mesh.vertex_numbers, table.vertex_count, "vertex number");
  check_ascending(mesh.triangle_numbers, table.triangle_count, "triangle number");
  for (std::size_t i = 0; i < vertex_count; ++i) {
    const Vec3& v = mesh.vertices[i];
    // Written so that a NaN is outside.
    if (!((v.array() >= entry.bounds.low.array()).all() && (v.array() <= entry.bounds.high.array()).all()))
      throw Flaw{
          fmt::format("vertex {} at ({}, {}, {}) is outside of its box", mesh.vertex_numbers[i], v[0], v[1], v[2])};
  }
  for (const TriangleCorners& corners : mesh.corners) {
    for (const std::uint32_t corner : corners) {
      if (corner >= vertex_count) throw Flaw{fmt::format("a corner is vertex {} of {}", corner, vertex_count)};
    }
  }
  check_parts(mesh, table, entry);
  return mesh;
}

}  // namespace

Aabb bounds_of(const TileMesh& tile) {
  Aabb bounds;
  for (const Vec3& vertex : tile.vertices) bounds.extend(vertex);
  return bounds;
}

std::uint32_t tile_checksum(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(crc32_z(0, nullptr, 0), reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::vector<std::byte> encode_tile(const TileMesh& tile) {
  flatbuffers::FlatBufferBuilder builder(256 + tile.vertices.size() * (sizeof(Vec3) + sizeof(std::uint32_t)) +
                                         tile.corners.size() * (sizeof(TriangleCorners) + sizeof(std::uint32_t)));
  const auto vertices = format::write_numbers<double>(builder, tile.vertices);
  const auto corners = format::write_numbers<std::uint32_t>(builder, tile.corners);
  const auto vertex_numbers = builder.CreateVector(tile.vertex_numbers);
  const auto triangle_numbers = builder.CreateVector(tile.triangle_numbers);
  builder.Finish(format::CreateTileMesh(builder, vertex_numbers, vertices, triangle_numbers, corners));
  const auto bytes = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
  return {bytes.begin(), bytes.end()};
}

std::vector<std::byte> encode_table(const TileContents& table, std::uint64_t first_byte) {
  flatbuffers::FlatBufferBuilder builder;
  std::vector<flatbuffers::Offset<format::TilePart>> parts;
  for (const TiledPart& part : table.parts) {
    const format::Vec3 low = packed(part.bounds.low);
    const format::Vec3 high = packed(part.bounds.high);
    const format::Filter filter = packed(part.filter);
    const auto name = builder.CreateString(part.name);
    const auto pieces = part.cut.piece_of ? builder.CreateVector(*part.cut.piece_of) : 0;
    parts.push_back(
        format::CreateTilePart(builder, name, part.triangle_count, part.tile_count, &low, &high, &filter, pieces));
  }
  std::vector<flatbuffers::Offset<format::Tile>> tiles;
  for (const TileEntry& tile : table.tiles) {
    const format::Vec3 low = packed(tile.bounds.low);
    const format::Vec3 high = packed(tile.bounds.high);
    tiles.push_back(format::CreateTileDirect(builder, &low, &high, tile.first_byte, tile.byte_count, tile.checksum,
                                             tile.vertex_count, tile.triangle_count, &tile.parts));
  }
  const auto name = builder.CreateString(table.name);
  const auto source = builder.CreateString(table.source);
  const auto part_vector = builder.CreateVector(parts);
  const auto tile_vector = builder.CreateVector(tiles);
  builder.Finish(format::CreateTileTable(builder, kTileFormat, name, source, table.vertex_count, table.triangle_count,
                                         part_vector, tile_vector));
  const auto written = std::as_bytes(std::span(builder.GetBufferPointer(), builder.GetSize()));
  std::vector<std::byte> bytes(written.begin(), written.end());
  TileFileEnd last{.table_first_byte = first_byte, .table_bytes = bytes.size(), .checksum = tile_checksum(bytes)};
  std::memcpy(last.magic, kMagic, sizeof kMagic);
  const auto end = std::as_bytes(std::span(&last, 1));
  bytes.insert(bytes.end(), end.begin(), end.end());
  return bytes;
}

TileContents decode_table(std::span<const std::byte> file) {
  const std::span<const std::byte> bytes = table_of(file);
  const format::AlignedBytes aligned(bytes);
  const auto* root = format::verified<format::TileTable>(aligned.data(), bytes.size(), nullptr);
  if (root == nullptr) throw Flaw{"damaged: its table of contents does not check out"};
  return TableDecoder(bytes.size()).decode(*root, static_cast<std::uint64_t>(bytes.data() - file.data()));
}

TileMesh decode_tile(std::span<const std::byte> file, const TileContents& table, std::size_t tile) {
  const TileEntry& entry = table.tiles[tile];
  const auto bytes = file.subspan(entry.first_byte, entry.byte_count);
  try {
    if (const std::uint32_t sum = tile_checksum(bytes); sum != entry.checksum)
      throw Flaw{fmt::format("its checksum is {:08x}, it should be {:08x}", sum, entry.checksum)};
    const format::AlignedBytes aligned(bytes);
    const auto* root = format::verified<format::TileMesh>(aligned.data(), bytes.size(), nullptr);
    if (root == nullptr) throw Flaw{"its tables do not check out"};
    return checked(*root, table, entry);
  } catch (const Flaw& flaw) {
    throw Flaw{fmt::format("tile {} of {}, {} bytes from {} on: {}", tile, table.tiles.size(), entry.byte_count,
                           entry.first_byte, flaw.what)};
  }
}

}  // namespace collided::engine
