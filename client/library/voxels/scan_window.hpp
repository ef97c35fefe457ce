#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "client/library/voxels/cell_ray.hpp"
#include "client/library/voxels/voxel_tile.hpp"

namespace collided::client {

/// A box of tile places.
struct PlaceBox {
  VoxelNumber low{};
  VoxelNumber high{};  // inclusive

  void extend(const VoxelNumber& place) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], place[axis]);
      high[axis] = std::max(high[axis], place[axis]);
    }
  }
  std::int64_t size(std::size_t axis) const { return std::int64_t{high[axis]} - low[axis] + 1; }
  std::int64_t count() const { return size(0) * size(1) * size(2); }
};

/// An array over the tiles of a box, with the tiles that rays of a scan still change.
class ScanWindow {
 public:
  /// 8 MB of pointers, cleared with each scan.
  static constexpr std::int64_t kMostTiles = 1 << 20;

  /// Sets all entries to null.
  ///
  /// box  of at most kMostTiles
  void begin_scan(const PlaceBox& box) {
    box_ = box;
    tiles_.assign(static_cast<std::size_t>(box.count()), nullptr);
  }
  BlockNumbering numbering() const {
    const std::int64_t y = box_.size(0), z = y * box_.size(1);
    return {.origin = -(box_.low[0] + box_.low[1] * y + box_.low[2] * z), .x = 1, .y = y, .z = z};
  }
  VoxelNumber place_of(std::int64_t number) const {
    const BlockNumbering by = numbering();
    return {box_.low[0] + static_cast<std::int32_t>(number % by.y),
            box_.low[1] + static_cast<std::int32_t>(number % by.z / by.y),
            box_.low[2] + static_cast<std::int32_t>(number / by.z)};
  }
  VoxelTile*& operator[](std::int64_t number) { return tiles_[static_cast<std::size_t>(number)]; }

 private:
  PlaceBox box_;
  std::vector<VoxelTile*> tiles_;
};

}  // namespace collided::client
