#include <algorithm>
#include <bit>
#include <cmath>

#include "client/library/connection/errors.hpp"
#include "client/library/voxels/byte_lanes.hpp"
#include "client/library/voxels/voxel_tiles.hpp"

namespace collided {

using client::bad_input;
using client::VoxelTile;
using client::words;

namespace {

constexpr std::int64_t kTicksOfDecay = 16;

double rounded_to_24_bits(double value) {
  int exponent = 0;
  const double bits = std::ldexp(std::frexp(value, &exponent), 24);
  return std::ldexp(std::nearbyint(bits), exponent - 24);
}

}  // namespace

Result<VoxelGrid> VoxelGrid::make(const VoxelOptions& options) {
  if (!(options.cell_m >= 1e-6 && options.cell_m <= 1e6))
    return bad_input("voxels of " + words(options.cell_m) + " m; allowed 1e-6 to 1e6");
  if (options.decay.count() < 0)
    return bad_input("voxels: a decay of " + words(options.decay) + "; allowed 0 and more");
  if (options.clearing_delay.count() < 0) return bad_input("voxels: a clearing delay below 0");
  if (!(options.reach_m > 0)) return bad_input("voxels: a reach of " + words(options.reach_m) + " m; allowed above 0");
  if (options.most_blocks == 0) return bad_input("voxels: no block may be in use");
  return VoxelGrid(std::make_unique<client::VoxelTiles>(options, rounded_to_24_bits(options.cell_m)));
}

VoxelGrid::VoxelGrid(std::unique_ptr<client::VoxelTiles> tiles) : tiles_(std::move(tiles)) {}
VoxelGrid::~VoxelGrid() = default;
VoxelGrid::VoxelGrid(VoxelGrid&&) noexcept = default;
VoxelGrid& VoxelGrid::operator=(VoxelGrid&&) noexcept = default;

VoxelScan VoxelGrid::insert(std::span<const double> points, const std::optional<Vec3>& origin,
                            std::chrono::nanoseconds time) {
  return tiles_->insert(points, origin, time);
}
VoxelScan VoxelGrid::insert(std::span<const float> points, const std::optional<Vec3>& origin,
                            std::chrono::nanoseconds time) {
  return tiles_->insert(points, origin, time);
}
VoxelScan VoxelGrid::assign(std::span<const VoxelBlock> blocks, std::chrono::nanoseconds time) {
  return tiles_->assign(blocks, time);
}
std::size_t VoxelGrid::decay(std::chrono::nanoseconds time) { return tiles_->decay(time); }
void VoxelGrid::clear() { tiles_->forget_all(); }
double VoxelGrid::cell_m() const { return tiles_->cell_m; }
std::size_t VoxelGrid::block_count() const { return tiles_->tiles.size(); }

std::size_t VoxelGrid::occupied_count() const {
  std::size_t count = 0;
  tiles_->tiles.for_each([&](const VoxelTile& tile) {
    for (const std::uint64_t word : tile.occupied) count += static_cast<std::size_t>(std::popcount(word));
  });
  return count;
}

VoxelState VoxelGrid::state(const VoxelNumber& cell) const {
  const VoxelTile* tile = std::as_const(tiles_->tiles).find(client::tile_of(cell));
  const std::size_t at = client::cell_in_tile(cell);
  if (tile == nullptr || !client::has_bit(tile->known, at)) return VoxelState::unknown;
  return client::has_bit(tile->occupied, at) ? VoxelState::occupied : VoxelState::free;
}

std::optional<VoxelNumber> VoxelGrid::cell_of(const Vec3& point) const {
  VoxelNumber cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<std::int32_t> number = client::cell_number(point[axis], tiles_->cell_m);
    if (!number) return std::nullopt;
    cell[static_cast<std::size_t>(axis)] = *number;
  }
  return cell;
}

VoxelScan client::VoxelTiles::assign(std::span<const VoxelBlock> blocks, std::chrono::nanoseconds time) {
  VoxelScan scan;
  tick_ = std::max(tick_, tick_of(time));
  met_.clear();
  for (const VoxelBlock& block : blocks) set_block(block, scan);
  // Cells that the map omits are unknown.
  tiles.for_each([&](VoxelTile& tile) {
    bool is_changed = false;
    for (std::size_t word = 0; word < client::kTileWords; ++word) {
      const std::uint64_t known = tile.hit[word] | tile.crossed[word];
      is_changed = is_changed || known != tile.known[word] || tile.hit[word] != tile.occupied[word];
      tile.known[word] = known;
      tile.occupied[word] = tile.hit[word];
      tile.hit[word] = tile.crossed[word] = 0;
    }
    tile.is_met = false;
    tile.fresh = {};
    if (!is_changed) return;
    ++scan.changed;
    note_changed(tile);
  });
  return scan;
}

void client::VoxelTiles::set_block(const VoxelBlock& block, VoxelScan& scan) {
  constexpr std::int32_t kMostSide = 65'536;
  const bool is_good = block.side >= 1 && block.side <= kMostSide &&
                       std::all_of(block.low.begin(), block.low.end(), [&](std::int32_t low) {
                         return low >= -client::kMostCellNumber && low <= client::kMostCellNumber - block.side;
                       });
  if (!is_good || block.state == VoxelState::unknown) {
    scan.refused += is_good ? 0 : 1;
    return;
  }
  ++scan.points;
  if (block.state == VoxelState::free && options.unknown == UnknownCells::free) return;
  const VoxelNumber high{block.low[0] + block.side - 1, block.low[1] + block.side - 1, block.low[2] + block.side - 1};
  const VoxelNumber first = client::tile_of(block.low), last = client::tile_of(high);
  for (std::int32_t z = first[2]; z <= last[2]; ++z) {
    for (std::int32_t y = first[1]; y <= last[1]; ++y) {
      for (std::int32_t x = first[0]; x <= last[0]; ++x) {
        if (VoxelTile* tile = met(tiles.found_or_made({x, y, z})); tile != nullptr) {
          set_cells(*tile, block, high, scan);
        } else {
          ++scan.dropped;
          return;
        }
      }
    }
  }
}

/// Sets the cells of the block that are in the tile.
void client::VoxelTiles::set_cells(VoxelTile& tile, const VoxelBlock& block, const VoxelNumber& high, VoxelScan& scan) {
  const bool is_occupied = block.state == VoxelState::occupied;
  VoxelNumber low{}, end{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int32_t begin = tile.place[axis] * client::kTileSide;
    low[axis] = std::max(block.low[axis], begin);
    end[axis] = std::min(high[axis] + 1, begin + client::kTileSide);
  }
  for (std::int32_t z = low[2]; z < end[2]; ++z) {
    for (std::int32_t y = low[1]; y < end[1]; ++y) {
      for (std::int32_t x = low[0]; x < end[0]; ++x) {
        const std::size_t cell = client::cell_in_tile({x, y, z});
        client::set_bit(is_occupied ? tile.hit : tile.crossed, cell);
        if (is_occupied) tile.odds[cell] = client::kMostOdds;
        tile.seen[cell] = static_cast<std::uint8_t>(tick_);
        ++(is_occupied ? scan.occupied : scan.crossed);
      }
    }
  }
}

std::int64_t client::VoxelTiles::tick_of(std::chrono::nanoseconds time) const {
  return options.decay.count() == 0 ? 0
                                    : time.count() / std::max<std::int64_t>(options.decay.count() / kTicksOfDecay, 1);
}

/// Ticks are kept modulo 256, which suffices since all cells are checked at every tick.
std::size_t client::VoxelTiles::decay(std::chrono::nanoseconds time) {
  tick_ = std::max(tick_, tick_of(time));
  const std::int64_t passed = tick_ - looked_at_tick_;
  if (options.decay.count() == 0 || passed == 0) return 0;
  looked_at_tick_ = tick_;
  std::size_t changed_count = 0;
  std::vector<VoxelNumber> empty;
  tiles.for_each([&](VoxelTile& tile) {
    if (!forget_old(tile, passed)) return;
    ++changed_count;
    note_changed(tile);
    if (tile.is_empty()) empty.push_back(tile.place);
  });
  if (!is_watched) {
    for (const VoxelNumber& place : empty) tiles.remove(place);
  }
  return changed_count;
}

bool client::VoxelTiles::forget_old(VoxelTile& tile, std::int64_t passed) const {
  constexpr std::int64_t kAllOld = 256 - kTicksOfDecay - 2;
  const auto oldest = static_cast<std::uint8_t>(passed >= kAllOld ? 0 : kTicksOfDecay);
  bool is_changed = false;
  if (tile.fresh_tick != tick_) tile.fresh = {};
  tile.fresh_tick = tick_;
  for (std::size_t word = 0; word < client::kTileWords; ++word) {
    const std::uint64_t stale = tile.known[word] & ~tile.fresh[word];
    if (stale == 0) continue;
    const std::uint64_t old =
        stale & client::lanes_older(&tile.seen[64 * word], static_cast<std::uint8_t>(tick_), oldest);
    is_changed = is_changed || old != 0;
    tile.known[word] &= ~old;
    tile.occupied[word] &= ~old;
  }
  return is_changed;
}

void client::VoxelTiles::forget_all() {
  tiles.for_each([&](VoxelTile& tile) {
    tile.known = tile.occupied = tile.fresh = {};
    note_changed(tile);
  });
  if (!is_watched) tiles.clear();
}

}  // namespace collided
