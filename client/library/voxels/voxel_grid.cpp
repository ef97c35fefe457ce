#include <algorithm>
#include <bit>
#include <cmath>

#include "client/library/connection/errors.hpp"
#include "client/library/voxels/voxel_tiles.hpp"

namespace collided {

using client::bad_input;
using client::RayStart;
using client::VoxelTile;
using client::words;

namespace {

// Log odds, in steps of 0.05.
constexpr int kHit = 17;
constexpr int kMiss = 8;
constexpr int kLeast = -kMiss;
constexpr int kMost = 70;
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

template <class Number>
VoxelScan client::VoxelTiles::insert(std::span<const Number> points, const std::optional<Vec3>& origin,
                                     std::chrono::nanoseconds time) {
  VoxelScan scan;
  tick_ = std::max(tick_, tick_of(time));
  met_.clear();
  ends_.clear();
  clear_ends_.clear();
  const std::optional<RayStart> start = origin ? client::ray_start(*origin, cell_m) : std::nullopt;
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
    const Vec3 point(points[i], points[i + 1], points[i + 2]);
    take_point(point, start ? &*start : nullptr, origin.value_or(Vec3::Zero()), scan);
  }
  scan.occupied = ends_.size();
  if (start) {
    for (const VoxelNumber& end : ends_) clear_way(*start, end, true);
    std::sort(clear_ends_.begin(), clear_ends_.end());
    clear_ends_.erase(std::unique(clear_ends_.begin(), clear_ends_.end()), clear_ends_.end());
    for (const VoxelNumber& end : clear_ends_) clear_way(*start, end, false);
  }
  apply(scan);
  scan.changed += decay(time);
  return scan;
}

void client::VoxelTiles::take_point(const Vec3& point, const RayStart* start, const Vec3& origin, VoxelScan& scan) {
  const double longest_m = std::min(options.reach_m, client::kLongestRayCells * cell_m);
  Vec3 at = point;
  bool is_far = false;
  if (start != nullptr) {
    const double length_m = (point - origin).norm();
    is_far = length_m > longest_m;
    if (is_far && std::isfinite(length_m)) at = origin + (point - origin) * (longest_m / length_m);
  }
  VoxelNumber cell{};
  for (int axis = 0; axis < 3; ++axis) {
    const std::optional<std::int32_t> number = client::cell_number(at[axis], cell_m);
    if (!number) {
      ++scan.refused;
      return;
    }
    cell[static_cast<std::size_t>(axis)] = *number;
  }
  if (is_far) {
    ++scan.far;
    clear_ends_.push_back(cell);
    return;
  }
  VoxelTile* tile = met(tiles.found_or_made(client::tile_of(cell)));
  if (tile == nullptr) {
    ++scan.dropped;
    return;
  }
  ++scan.points;
  const std::size_t bit = client::cell_in_tile(cell);
  if (client::has_bit(tile->hit, bit)) return;
  client::set_bit(tile->hit, bit);
  ends_.push_back(cell);
}

VoxelTile* client::VoxelTiles::met(VoxelTile* tile) {
  if (tile == nullptr || tile->is_met) return tile;
  tile->is_met = true;
  met_.push_back(tile);
  return tile;
}

/// Whether a ray through the tile may change something. Free cells are kept only where unknown ones are something else;
/// there, one scan a tick keeps what is free from decay.
bool client::VoxelTiles::can_change(const VoxelTile& tile) const {
  if (tile.has_occupied) return true;
  return options.unknown != UnknownCells::free && !(tile.is_all_known && tile.applied_tick == tick_);
}

void client::VoxelTiles::clear_way(const RayStart& start, const VoxelNumber& end, bool has_point) {
  const bool makes_tiles = options.unknown != UnknownCells::free;
  client::CellWalk walk(start, end);
  while (!walk.is_at_end()) {
    const VoxelNumber place = client::tile_of(walk.cell());
    VoxelTile* tile = makes_tiles ? tiles.found_or_made(place) : tiles.find(place);
    if (tile == nullptr || !can_change(*tile)) {
      walk.leave_block(client::kTileSide);
      continue;
    }
    met(tile);
    do {
      client::set_bit(tile->crossed, client::cell_in_tile(walk.cell()));
      walk.step();
    } while (!walk.is_at_end() && client::tile_of(walk.cell()) == place);
  }
  if (has_point) return;
  VoxelTile* tile = met(makes_tiles ? tiles.found_or_made(client::tile_of(end)) : tiles.find(client::tile_of(end)));
  if (tile != nullptr) client::set_bit(tile->crossed, client::cell_in_tile(end));
}

void client::VoxelTiles::note_changed(VoxelTile& tile) {
  if (!is_watched || tile.is_changed) return;
  tile.is_changed = true;
  changed.push_back(&tile);
}

/// A point counts more than a ray through its cell: those of one scan graze the cells of each other's points.
void client::VoxelTiles::apply(VoxelScan& scan) {
  const auto tick = static_cast<std::uint8_t>(tick_);
  for (VoxelTile* tile : met_) {
    bool is_changed = false;
    for (std::size_t word = 0; word < client::kTileWords; ++word) {
      const std::uint64_t hit = tile->hit[word];
      const std::uint64_t crossed = tile->crossed[word] & ~hit;
      if ((hit | crossed) == 0) continue;
      scan.crossed += static_cast<std::size_t>(std::popcount(crossed));
      const std::uint64_t known = tile->known[word];
      std::uint64_t occupied = tile->occupied[word];
      for (std::uint64_t rest = hit | crossed; rest != 0; rest &= rest - 1) {
        const auto bit = static_cast<std::size_t>(std::countr_zero(rest));
        const std::uint64_t mask = std::uint64_t{1} << bit;
        const std::size_t cell = 64 * word + bit;
        const int before = (known & mask) != 0 ? tile->odds[cell] : 0;
        const int after = (hit & mask) != 0 ? std::min(before + kHit, kMost) : std::max(before - kMiss, kLeast);
        tile->odds[cell] = static_cast<std::int8_t>(after);
        tile->seen[cell] = tick;
        occupied = after >= 0 ? occupied | mask : occupied & ~mask;
      }
      is_changed = is_changed || occupied != tile->occupied[word] || (known | hit | crossed) != known;
      tile->occupied[word] = occupied;
      tile->known[word] = known | hit | crossed;
      tile->hit[word] = tile->crossed[word] = 0;
    }
    tile->is_met = false;
    tile->applied_tick = tick_;
    if (!is_changed) continue;
    tile->note_bits();
    ++scan.changed;
    note_changed(*tile);
  }
}

VoxelScan client::VoxelTiles::assign(std::span<const VoxelBlock> blocks, std::chrono::nanoseconds time) {
  VoxelScan scan;
  tick_ = std::max(tick_, tick_of(time));
  met_.clear();
  for (const VoxelBlock& block : blocks) set_block(block, scan);
  // What the map does not name it does not know.
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
    if (!is_changed) return;
    tile.note_bits();
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

/// The cells of the block that are in the tile.
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
        tile.odds[cell] = static_cast<std::int8_t>(is_occupied ? kMost : kLeast);
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

/// Ticks are kept modulo 256, which is enough while all cells are looked at whenever a tick has passed.
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
  const auto tick = static_cast<std::uint8_t>(tick_);
  bool is_changed = false;
  for (std::size_t word = 0; word < client::kTileWords; ++word) {
    std::uint64_t old = 0;
    for (std::uint64_t rest = tile.known[word]; rest != 0; rest &= rest - 1) {
      const auto bit = static_cast<std::size_t>(std::countr_zero(rest));
      const auto age = static_cast<std::uint8_t>(tick - tile.seen[64 * word + bit]);
      if (age > kTicksOfDecay || (passed >= kAllOld && age != 0)) old |= std::uint64_t{1} << bit;
    }
    is_changed = is_changed || old != 0;
    tile.known[word] &= ~old;
    tile.occupied[word] &= ~old;
  }
  if (is_changed) tile.note_bits();
  return is_changed;
}

void client::VoxelTiles::forget_all() {
  tiles.for_each([&](VoxelTile& tile) {
    tile.known = tile.occupied = {};
    tile.note_bits();
    note_changed(tile);
  });
  if (!is_watched) tiles.clear();
}

}  // namespace collided
