#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "collided/voxels.hpp"
#include "tests/oracle/voxel_oracle.hpp"

namespace collided::oracle {

/// Whether a segment meets the inside of a cell, by its stretches within the cell along each axis, as fractions.
///
/// from_64ths, to_64ths  in 64ths of a cell, which differ along each axis
inline bool meets_inside(const std::array<std::int64_t, 3>& from_64ths, const std::array<std::int64_t, 3>& to_64ths,
                         const CellNumbers& cell) {
  std::array<std::int64_t, 3> begin{}, end{}, whole{};  // over `whole`
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t way = to_64ths[axis] - from_64ths[axis];
    const std::int64_t low = 64 * std::int64_t{cell[axis]} - from_64ths[axis];
    whole[axis] = std::abs(way);
    begin[axis] = std::max<std::int64_t>(way > 0 ? low : -(low + 64), 0);
    end[axis] = std::min(way > 0 ? low + 64 : -low, whole[axis]);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    for (std::size_t b = 0; b < 3; ++b) {
      if (begin[a] * whole[b] >= end[b] * whole[a]) return false;
    }
  }
  return true;
}

/// A grid of cells as voxels.hpp describes it, cell by cell and ray by ray: what VoxelGrid is to agree with. Its points are
/// given by their cells, and its sensor in 64ths of a cell, odd ones.
class PlainGrid {
 public:
  explicit PlainGrid(const VoxelOptions& options) : options_(options) {}

  void insert(const std::vector<CellNumbers>& points, const std::optional<std::array<std::int64_t, 3>>& sensor_64ths,
              std::int64_t tick) {
    const std::set<CellNumbers> hit(points.begin(), points.end());
    std::set<CellNumbers> crossed;
    for (const CellNumbers& end : hit) {
      if (sensor_64ths) add_crossed(*sensor_64ths, end, crossed);
    }
    std::erase_if(crossed, [&](const CellNumbers& cell) { return hit.contains(cell); });
    for (const CellNumbers& cell : hit) meet(cell, 17, tick);
    for (const CellNumbers& cell : crossed) meet(cell, -8, tick);
    std::erase_if(cells_, [&](const auto& entry) { return tick - entry.second.tick > 16; });
  }
  VoxelState state(const CellNumbers& cell) const {
    const auto found = cells_.find(cell);
    if (found == cells_.end()) return VoxelState::unknown;
    return found->second.odds >= 0 ? VoxelState::occupied : VoxelState::free;
  }
  std::size_t size() const { return cells_.size(); }

 private:
  static void add_crossed(const std::array<std::int64_t, 3>& from_64ths, const CellNumbers& end,
                          std::set<CellNumbers>& crossed) {
    std::array<std::int64_t, 3> to_64ths{};
    CellNumbers low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      to_64ths[axis] = 64 * std::int64_t{end[axis]} + 32;
      const auto start = static_cast<std::int32_t>(from_64ths[axis] >> 6);
      low[axis] = std::min(start, end[axis]);
      high[axis] = std::max(start, end[axis]);
    }
    for (std::int32_t x = low[0]; x <= high[0]; ++x) {
      for (std::int32_t y = low[1]; y <= high[1]; ++y) {
        for (std::int32_t z = low[2]; z <= high[2]; ++z) {
          if (meets_inside(from_64ths, to_64ths, {x, y, z})) crossed.insert({x, y, z});
        }
      }
    }
  }

  struct Kept {
    int odds = 0;  // steps of 0.05
    std::int64_t tick = 0;
  };
  void meet(const CellNumbers& cell, int by, std::int64_t tick) {
    Kept& kept = cells_[cell];
    kept.odds = std::clamp(kept.odds + by, -8, 70);
    if (kept.odds < 0) kept.odds = -8;
    kept.tick = tick;
    if (kept.odds < 0 && options_.unknown == UnknownCells::free) cells_.erase(cell);
  }

  VoxelOptions options_;
  std::map<CellNumbers, Kept> cells_;
};

}  // namespace collided::oracle
