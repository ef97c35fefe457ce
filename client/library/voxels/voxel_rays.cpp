#include <algorithm>
#include <bit>
#include <cmath>

#include "client/library/voxels/voxel_tiles.hpp"

namespace collided::client {
namespace {

constexpr std::int32_t kBrickMask = (1 << kBrickBits) - 1;
constexpr std::int32_t kBricksMask = (1 << (kTileBits - kBrickBits)) - 1;
/// Numbers cells in a brick, and bricks in a tile.
constexpr BlockNumbering kFours{.origin = 0, .x = 1, .y = 4, .z = 16};

/// The bits of the cells that a ray meets between two times at which it is within one brick.
std::uint64_t cells_met(const CellRay& ray, std::int64_t from, std::int64_t until) {
  std::uint64_t met = 0;
  for (BlockWalk<0> walk(ray, from, kFours, kBrickMask);; walk.step()) {
    met |= std::uint64_t{1} << walk.at();
    if (walk.leaves() >= until) return met;
  }
}

/// Marks the cells that a ray meets between two times at which it is within one tile.
void cross(VoxelTile& tile, const CellRay& ray, std::int64_t from, std::int64_t until) {
  for (BlockWalk<kBrickBits> walk(ray, from, kFours, kBricksMask);; walk.step()) {
    const std::int64_t leaves = std::min(walk.leaves(), until);
    const auto brick = static_cast<std::size_t>(walk.at());
    if ((tile.settled >> brick & 1) == 0) {
      tile.crossed[brick] |= cells_met(ray, from, leaves);
      if ((tile.open[brick] & ~tile.crossed[brick]) == 0) tile.settled |= std::uint64_t{1} << brick;
    }
    if (leaves == until) return;
    from = leaves;
  }
}

/// Walks a ray from a time on through the tiles that find(number) returns; null: a tile in which it changes nothing.
template <class Find>
void clear_way(const CellRay& ray, std::int64_t from, const BlockNumbering& by, Find&& find) {
  for (BlockWalk<kTileBits> walk(ray, from, by);; walk.step()) {
    const std::int64_t until = std::min(walk.leaves(), ray.end);
    if (VoxelTile* tile = find(walk.at()); tile != nullptr) cross(*tile, ray, from, until);
    if (until == ray.end) return;
    from = until;
  }
}

}  // namespace

/// Follows each ray once, however many points its cell has. It goes tile by tile, so that nearby rays follow each
/// other.
void VoxelTiles::clear_ways(const RayStart& start) {
  const std::size_t with_points = met_.size();
  std::sort(clear_ends_.begin(), clear_ends_.end());
  clear_ends_.erase(std::unique(clear_ends_.begin(), clear_ends_.end()), clear_ends_.end());
  PlaceBox box{.low = tile_of(start.cell), .high = tile_of(start.cell)};
  for (std::size_t i = 0; i < with_points; ++i) {
    box.extend(met_[i]->place);
    open(*met_[i]);
  }
  for (const VoxelNumber& end : clear_ends_) box.extend(tile_of(end));
  const bool has_window = box.count() <= ScanWindow::kMostTiles;
  if (has_window) window_.begin_scan(box);
  const BlockNumbering by = has_window ? window_.numbering() : TileTable::kKeys;
  const auto clear = [&](const VoxelNumber& end) {
    const CellRay ray(start, end);
    if (has_window) clear_way(ray, 0, by, [this](std::int64_t number) { return in_window(number); });
    else clear_way(ray, 0, by, [this](std::int64_t key) { return in_table(TileTable::place_of(key)); });
  };
  for (std::size_t i = 0; i < with_points; ++i) {
    const VoxelTile& tile = *met_[i];
    for (std::size_t word = 0; word < kTileWords; ++word) {
      for (std::uint64_t rest = tile.hit[word]; rest != 0; rest &= rest - 1)
        clear(cell_of(tile.place, 64 * word + static_cast<std::size_t>(std::countr_zero(rest))));
    }
  }
  for (const VoxelNumber& end : clear_ends_) clear(end);
}

/// Marks the cells that a ray would change. A ray changes free cells only once per tick, when it records that they were
/// met.
void VoxelTiles::open(VoxelTile& tile) const {
  tile.settled = 0;
  for (std::size_t word = 0; word < kTileWords; ++word) {
    const std::uint64_t fresh = tile.fresh_tick == tick_ ? tile.fresh[word] : 0;
    const std::uint64_t wanted = keeps_free() ? tile.occupied[word] | ~fresh : tile.occupied[word];
    tile.open[word] = wanted & ~tile.hit[word];
    if (tile.open[word] == 0) tile.settled |= std::uint64_t{1} << word;
  }
}

/// The tile at that place if a ray may change it, else null. Makes the tile if free cells are kept.
VoxelTile* VoxelTiles::in_table(const VoxelNumber& place) {
  VoxelTile* tile = keeps_free() ? tiles.found_or_made(place) : tiles.find(place);
  if (tile == nullptr) return nullptr;
  if (!tile->is_met) open(*met(tile));
  return tile->settled == kAllBits ? nullptr : tile;
}

VoxelTile* VoxelTiles::in_window(std::int64_t number) {
  VoxelTile*& kept = window_[number];
  if (kept == &nothing_) return nullptr;
  if (kept == nullptr) kept = in_table(window_.place_of(number));
  else if (kept->settled == kAllBits) kept = nullptr;
  if (kept == nullptr) kept = &nothing_;
  return kept == &nothing_ ? nullptr : kept;
}

}  // namespace collided::client
