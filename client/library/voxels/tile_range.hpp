#pragma once

#include <algorithm>

#include "collided/voxels.hpp"

namespace collided::client {

/// A box of tiles, from low (inclusive) to end (exclusive) along each axis.
struct TileRange {
  VoxelNumber low{};
  VoxelNumber end{};
  bool operator==(const TileRange&) const = default;
  bool is_empty() const { return low == end; }
  void extend(const VoxelNumber& place) {
    const bool was_empty = is_empty();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = was_empty ? place[axis] : std::min(low[axis], place[axis]);
      end[axis] = was_empty ? place[axis] + 1 : std::max(end[axis], place[axis] + 1);
    }
  }
};

}  // namespace collided::client
