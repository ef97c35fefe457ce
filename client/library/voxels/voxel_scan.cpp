#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "client/library/voxels/byte_lanes.hpp"
#include "client/library/voxels/voxel_tiles.hpp"

namespace collided::client {
namespace {

// Log odds, in steps of 0.05.
constexpr int kHit = 17;
constexpr int kMiss = 8;
constexpr int kFree = -kMiss;

}  // namespace

template <class Number>
VoxelScan VoxelTiles::insert(std::span<const Number> points, const std::optional<Vec3>& origin,
                             std::chrono::nanoseconds time) {
  VoxelScan scan;
  tick_ = std::max(tick_, tick_of(time));
  met_.clear();
  clear_ends_.clear();
  const std::optional<RayStart> start = origin ? ray_start(*origin, cell_m) : std::nullopt;
  take_points(points, start ? *origin : std::optional<Vec3>(), scan);
  if (start) clear_ways(*start);
  apply(scan);
  scan.changed += decay(time);
  return scan;
}
template VoxelScan VoxelTiles::insert(std::span<const float>, const std::optional<Vec3>&, std::chrono::nanoseconds);
template VoxelScan VoxelTiles::insert(std::span<const double>, const std::optional<Vec3>&, std::chrono::nanoseconds);

template <class Number>
void VoxelTiles::take_points(std::span<const Number> points, const std::optional<Vec3>& origin, VoxelScan& scan) {
  const double longest_m = std::min(options.reach_m, kLongestRayCells * cell_m);
  // Most points are so near that no square root is needed.
  const double surely_m2 = longest_m * longest_m * (1 - 1e-12);
  VoxelTile* tile = nullptr;
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    Vec3 at(points[i], points[i + 1], points[i + 2]);
    bool is_far = false;
    if (origin) {
      const Vec3 way = at - *origin;
      const double length_m = way.squaredNorm() < surely_m2 ? 0 : way.norm();
      is_far = length_m > longest_m;
      if (is_far && std::isfinite(length_m)) at = *origin + way * (longest_m / length_m);
    }
    VoxelNumber cell{};
    if (!number_cell(at, cell)) {
      ++scan.refused;
    } else if (is_far) {
      ++scan.far;
      clear_ends_.push_back(cell);
    } else {
      // Points of a scan come in rows.
      const VoxelNumber place = tile_of(cell);
      if (tile == nullptr || TileTable::key_of(tile->place) != TileTable::key_of(place))
        tile = met(tiles.found_or_made(place));
      ++(tile != nullptr ? scan.points : scan.dropped);
      if (tile != nullptr) set_bit(tile->hit, cell_in_tile(cell));
    }
  }
  for (const VoxelTile* with_points : met_) {
    for (const std::uint64_t word : with_points->hit) scan.occupied += static_cast<std::size_t>(std::popcount(word));
  }
}

bool VoxelTiles::number_cell(const Vec3& point, VoxelNumber& cell) const {
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<std::int32_t> number = cell_number(point[axis], cell_m);
    if (!number) return false;
    cell[static_cast<std::size_t>(axis)] = *number;
  }
  return true;
}

VoxelTile* VoxelTiles::met(VoxelTile* tile) {
  if (tile == nullptr || tile->is_met) return tile;
  tile->is_met = true;
  tile->crossed = {};
  met_.push_back(tile);
  return tile;
}

void VoxelTiles::note_changed(VoxelTile& tile) {
  if (!is_watched || tile.is_changed) return;
  tile.is_changed = true;
  changed.push_back(&tile);
}

/// A point outweighs rays through its cell, since rays of a scan graze the cells of other points.
void VoxelTiles::apply(VoxelScan& scan) {
  for (VoxelTile* tile : met_) {
    if (tile->fresh_tick != tick_) tile->fresh = {};
    tile->fresh_tick = tick_;
    bool is_changed = false;
    for (std::size_t word = 0; word < kTileWords; ++word) {
      const std::uint64_t crossed = tile->crossed[word] & tile->open[word];
      scan.crossed += static_cast<std::size_t>(std::popcount(crossed));
      if ((tile->hit[word] | crossed) != 0) is_changed |= apply_brick(*tile, word, crossed);
    }
    tile->hit = {};
    tile->is_met = false;
    if (!is_changed) continue;
    ++scan.changed;
    note_changed(*tile);
  }
}

/// Returns true if cells have changed.
bool VoxelTiles::apply_brick(VoxelTile& tile, std::size_t word, std::uint64_t crossed) const {
  const std::uint64_t hit = tile.hit[word], known = tile.known[word];
  std::uint64_t occupied = tile.occupied[word];
  std::int8_t* const odds = &tile.odds[64 * word];
  for (std::uint64_t rest = hit | (crossed & occupied); rest != 0; rest &= rest - 1) {
    const auto cell = static_cast<std::size_t>(std::countr_zero(rest));
    const std::uint64_t mask = std::uint64_t{1} << cell;
    const int before = (occupied & mask) != 0 ? odds[cell] : (known & mask) != 0 ? kFree : 0;
    const int after = (hit & mask) != 0 ? std::min(before + kHit, kMostOdds) : before - kMiss;
    odds[cell] = static_cast<std::int8_t>(after);
    occupied = after >= 0 ? occupied | mask : occupied & ~mask;
  }
  const std::uint64_t met = hit | crossed, now_known = keeps_free() ? known | met : occupied;
  const bool is_changed = occupied != tile.occupied[word] || now_known != known;
  if (const std::uint64_t stale = met & ~tile.fresh[word]; stale != 0)
    set_lanes(&tile.seen[64 * word], stale, static_cast<std::uint8_t>(tick_));
  tile.occupied[word] = occupied;
  tile.known[word] = now_known;
  tile.fresh[word] = (tile.fresh[word] | met) & now_known;
  return is_changed;
}

}  // namespace collided::client
