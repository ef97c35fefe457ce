#pragma once

#include <optional>
#include <span>
#include <vector>

#include "client/library/voxels/cell_ray.hpp"
#include "client/library/voxels/scan_window.hpp"
#include "client/library/voxels/tile_table.hpp"

namespace collided::client {

/// Maximum log odds, in steps of 0.05.
inline constexpr int kMostOdds = 70;

/// The tiles of a grid, and the current scan.
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
  // True if an owner takes the changes and removes empty tiles.
  bool is_watched = false;
  std::vector<VoxelTile*> changed;

 private:
  /// Free cells are kept only if unknown cells differ from free ones.
  bool keeps_free() const { return options.unknown != UnknownCells::free; }
  template <class Number>
  void take_points(std::span<const Number> points, const std::optional<Vec3>& origin, VoxelScan& scan);
  bool number_cell(const Vec3& point, VoxelNumber& cell) const;
  VoxelTile* met(VoxelTile * tile);
  void clear_ways(const RayStart& start);
  void open(VoxelTile & tile) const;
  VoxelTile* in_table(const VoxelNumber& place);
  VoxelTile* in_window(std::int64_t number);
  void apply(VoxelScan & scan);
  bool apply_brick(VoxelTile & tile, std::size_t word, std::uint64_t crossed) const;
  void set_block(const VoxelBlock& block, VoxelScan& scan);
  void set_cells(VoxelTile & tile, const VoxelBlock& block, const VoxelNumber& high, VoxelScan& scan);
  bool forget_old(VoxelTile & tile, std::int64_t passed) const;
  void note_changed(VoxelTile & tile);
  std::int64_t tick_of(std::chrono::nanoseconds time) const;

  std::vector<VoxelTile*> met_;          // by the current scan
  std::vector<VoxelNumber> clear_ends_;  // ends of rays that are longer than the reach
  ScanWindow window_;                    // of the current scan
  VoxelTile nothing_;                    // placeholder in the window for tiles in which rays change nothing
  std::int64_t tick_ = 0;                // of the newest time
  std::int64_t looked_at_tick_ = 0;      // when all cells were last checked
};

}  // namespace collided::client
