#include "server/intake/tiles/tile_writer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <utility>

#include "server/intake/file_bytes.hpp"
#include "server/intake/scene_file/write_file.hpp"
#include "server/intake/tiles/scratch_file.hpp"
#include "server/intake/tiles/tile_format.hpp"
#include "server/intake/tiles/tile_split.hpp"

namespace collided::engine {
namespace {

/// A triangle on its way to its tile.
struct SortedTriangle {
  std::uint32_t number = 0;
  TriangleCorners corners{};
};
static_assert(sizeof(SortedTriangle) == 16);

/// The triangles of all tiles in one scratch file, those of each tile together and in their order.
class TriangleSort {
 public:
  /// counts  of the triangles in each tile
  TriangleSort(const std::string& beside, std::vector<std::uint64_t> counts)
      : file_(beside), counts_(std::move(counts)), ends_(counts_.size()), waiting_(counts_.size()) {
    std::uint64_t end = 0;
    for (std::size_t tile = 0; tile < counts_.size(); ++tile) ends_[tile] = std::exchange(end, end + counts_[tile]);
    constexpr std::size_t kWaiting = std::size_t{2} << 20;  // of all tiles together
    most_waiting_ = std::clamp<std::size_t>(kWaiting / std::max<std::size_t>(counts_.size(), 1), 16, 4096);
  }

  void add(std::size_t tile, const SortedTriangle& triangle) {
    waiting_[tile].push_back(triangle);
    if (waiting_[tile].size() >= most_waiting_) flush(tile);
  }

  /// The triangles of a tile. After the first call, none may be added.
  std::vector<SortedTriangle> of_tile(std::size_t tile) {
    flush(tile);
    waiting_[tile] = {};
    std::vector<SortedTriangle> triangles(counts_[tile]);
    file_.read((ends_[tile] - counts_[tile]) * sizeof(SortedTriangle), std::as_writable_bytes(std::span(triangles)));
    return triangles;
  }

 private:
  void flush(std::size_t tile) {
    file_.write(ends_[tile] * sizeof(SortedTriangle), std::as_bytes(std::span(waiting_[tile])));
    ends_[tile] += waiting_[tile].size();
    waiting_[tile].clear();
  }

  ScratchFile file_;
  std::vector<std::uint64_t> counts_;
  std::vector<std::uint64_t> ends_;  // of what was written of each tile
  std::vector<std::vector<SortedTriangle>> waiting_;
  std::size_t most_waiting_ = 0;
};

class TileWriting {
 public:
  TileWriting(const std::string& path, MeshSource& mesh, const TilingOptions& options)
      : path_(path), mesh_(mesh), options_(options) {}

  TilingReport run(const std::string& name, const std::string& source, const std::vector<Part>& parts) {
    if (mesh_.triangle_count() == 0) fail("it holds no triangles, and tiles are of triangles");
    begin_table(name, source, parts);
    if (options_.size_m) split_ = std::make_unique<CubeSplit>(*options_.size_m);
    else split_ = std::make_unique<MedianSplit>(options_.most_triangles);
    visit(0, [&](std::uint32_t, const TriangleCorners&, const Vec3& at) { split_->see(at); });
    split_->finish();
    std::vector<std::uint64_t> counts(split_->tile_count());
    visit(1, [&](std::uint32_t, const TriangleCorners&, const Vec3& at) { ++counts[split_->tile_of(at)]; });
    check(counts);
    TriangleSort sorted(path_, counts);
    visit(2, [&](std::uint32_t number, const TriangleCorners& corners, const Vec3& at) {
      sorted.add(split_->tile_of(at), {number, corners});
    });
    FileReplacement file(path_);
    for (std::size_t tile = 0; tile < counts.size(); ++tile) {
      tell(3 + static_cast<double>(tile) / static_cast<double>(counts.size()));
      if (counts[tile] > 0) write_tile(file, sorted.of_tile(tile));
    }
    put(file, encode_table(table_, report_.bytes));
    tell(kPasses);
    if (const std::string failure = file.put_in_place(); !failure.empty()) fail(failure);
    return report_;
  }

 private:
  static constexpr double kPasses = 4;  // of about the same length

  [[noreturn]] void fail(const std::string& what) const {
    throw LoadError(fmt::format("{}: {}. Nothing was written.", file_name(path_), what));
  }

  /// passes_done  of kPasses
  void tell(double passes_done) const {
    if (options_.cancelled && options_.cancelled()) fail("cancelled");
    if (options_.progress) options_.progress(passes_done / kPasses);
  }

  void begin_table(const std::string& name, const std::string& source, const std::vector<Part>& parts) {
    table_ = {.name = name,
              .source = source,
              .vertex_count = static_cast<std::uint32_t>(mesh_.vertex_count()),
              .triangle_count = static_cast<std::uint32_t>(mesh_.triangle_count())};
    for (const Part& part : parts)
      table_.parts.push_back({.name = part.name,
                              .filter = part.filter,
                              .cut = part.cut,
                              .first_triangle = part.first_triangle,
                              .triangle_count = part.triangle_count});
  }

  /// Calls see(number, corners, centroid) for every triangle.
  template <class See>
  void visit(int pass, const See& see) {
    mesh_.visit_triangles([&](std::uint32_t first, std::span<const TriangleCorners> triangles) {
      tell(pass + static_cast<double>(first) / static_cast<double>(mesh_.triangle_count()));
      for (const TriangleCorners& corners : triangles) see(first++, corners, centroid(mesh_.triangle(corners)));
    });
  }

  void check(const std::vector<std::uint64_t>& counts) {
    for (const std::uint64_t count : counts) report_.largest_triangles = std::max(report_.largest_triangles, count);
    if (report_.largest_triangles > kMostTileTriangles)
      fail(fmt::format("a tile of {} triangles, limit {}; smaller tiles will do", report_.largest_triangles,
                       kMostTileTriangles));
  }

  void write_tile(FileReplacement& file, const std::vector<SortedTriangle>& triangles) {
    TileMesh tile;
    tile.vertex_numbers.reserve(3 * triangles.size());
    for (const SortedTriangle& triangle : triangles)
      tile.vertex_numbers.insert(tile.vertex_numbers.end(), triangle.corners.begin(), triangle.corners.end());
    std::ranges::sort(tile.vertex_numbers);
    const auto repeated = std::ranges::unique(tile.vertex_numbers);
    tile.vertex_numbers.erase(repeated.begin(), repeated.end());
    for (const std::uint32_t number : tile.vertex_numbers) tile.vertices.push_back(mesh_.vertex(number));
    for (const SortedTriangle& triangle : triangles) {
      TriangleCorners& corners = tile.corners.emplace_back(triangle.corners);
      for (std::uint32_t& corner : corners)
        corner = static_cast<std::uint32_t>(std::ranges::lower_bound(tile.vertex_numbers, corner) -
                                            tile.vertex_numbers.begin());
      tile.triangle_numbers.push_back(triangle.number);
    }
    add_entry(tile, encode_tile(tile), file);
  }

  void add_entry(const TileMesh& tile, const std::vector<std::byte>& bytes, FileReplacement& file) {
    TileEntry& entry =
        table_.tiles.emplace_back(TileEntry{.bounds = bounds_of(tile),
                                            .first_byte = report_.bytes,
                                            .byte_count = bytes.size(),
                                            .checksum = tile_checksum(bytes),
                                            .vertex_count = static_cast<std::uint32_t>(tile.vertices.size()),
                                            .triangle_count = static_cast<std::uint32_t>(tile.corners.size())});
    for (std::size_t i = 0; i < tile.corners.size(); ++i) {
      const std::uint32_t part = part_of(tile.triangle_numbers[i]);
      if (entry.parts.empty() || entry.parts.back() != part) {
        entry.parts.push_back(part);
        ++table_.parts[part].tile_count;
      }
      for (const std::uint32_t corner : tile.corners[i]) table_.parts[part].bounds.extend(tile.vertices[corner]);
    }
    put(file, bytes);
    constexpr std::array<std::byte, kTileBlockBytes> kPadding{};
    put(file, std::span(kPadding).first((kTileBlockBytes - bytes.size() % kTileBlockBytes) % kTileBlockBytes));
    ++report_.tiles;
  }

  std::uint32_t part_of(std::uint32_t triangle) const {
    const auto after = std::ranges::upper_bound(table_.parts, triangle, {}, &TiledPart::first_triangle);
    return static_cast<std::uint32_t>(after - table_.parts.begin() - 1);
  }

  void put(FileReplacement& file, std::span<const std::byte> bytes) {
    if (const std::string failure = file.append(bytes); !failure.empty()) fail(failure);
    report_.bytes += bytes.size();
  }

  std::string path_;
  MeshSource& mesh_;
  const TilingOptions& options_;
  std::unique_ptr<TileSplit> split_;
  TileContents table_;
  TilingReport report_;
};

}  // namespace

TilingReport write_tiles(const std::string& path, const std::string& name, const std::string& source,
                         const std::vector<Part>& parts, MeshSource& mesh, const TilingOptions& options) {
  return TileWriting(path, mesh, options).run(name, source, parts);
}

}  // namespace collided::engine
