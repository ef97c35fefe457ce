#pragma once

#include <optional>
#include <span>
#include <vector>

#include "client/library/voxels/cell_walk.hpp"
#include "client/library/voxels/tile_table.hpp"

namespace collided::client {

/// The tiles of a grid, and the scan at work.
struct [[gnu::visibility("hidden")]] VoxelTiles {
  VoxelTiles(const VoxelOptions& asked, double rounded_m)
      : options(asked), cell_m(rounded_m), tiles(asked.most_blocks) {}

  template <class Number>
  VoxelScan insert(std::span<const Number> points, const std::optional<Vec3>& origin, std::chrono::nanoseconds time);
  VoxelScan assign(std::span<const VoxelBlock> blocks, std::chrono::nanoseconds time);
  std::size_t decay(std::chrono::nanoseconds time);
  void forget_all();

  VoxelOptions options;
  double cell_m;
  TileTable tiles;
  // An owner takes what has changed, and removes the tiles that are empty then.
  bool is_watched = false;
  std::vector<VoxelTile*> changed;

 private:
  void take_point(const Vec3& point, const RayStart* start, const Vec3& origin, VoxelScan& scan);
  bool can_change(const VoxelTile& tile) const;
  void clear_way(const RayStart& start, const VoxelNumber& end, bool has_point);
  VoxelTile* met(VoxelTile * tile);
  void apply(VoxelScan & scan);
  void set_block(const VoxelBlock& block, VoxelScan& scan);
  void set_cells(VoxelTile & tile, const VoxelBlock& block, const VoxelNumber& high, VoxelScan& scan);
  bool forget_old(VoxelTile & tile, std::int64_t passed) const;
  void note_changed(VoxelTile & tile);
  std::int64_t tick_of(std::chrono::nanoseconds time) const;

  std::vector<VoxelTile*> met_;          // by the scan at work
  std::vector<VoxelNumber> ends_;        // cells with points of the scan at work, once each
  std::vector<VoxelNumber> clear_ends_;  // where rays end that are longer than the reach
  std::int64_t tick_ = 0;                // of the newest time
  std::int64_t looked_at_tick_ = 0;      // when all cells were last looked at
};

}  // namespace collided::client
