#pragma once

#include <algorithm>

#include "server/broad_phase/grid.hpp"
#include "server/broad_phase/grid_levels.hpp"

namespace collided::grid {

/// The walks of Grid over its levels; pairs and boxes in SIMD, chosen at run time.
void find_pairs(const Levels& levels, Grid::PairFound found, void* context, WalkCost& cost);
void walk_box(const Levels& levels, const Aabb& asked, Grid::BoxFound found, void* context, WalkCost& cost);
void walk_ray(const Levels& levels, const Ray& ray, double limit, Grid::RayFound found, void* context,
              WalkCost& cost);
void walk_near(const Levels& levels, const Vec3& point, double limit_m2, Grid::NearFound found, void* context,
               WalkCost& cost);

/// Cells whose boxes may reach [low, high], within the occupied ones; may be empty (low > high on some axis).
CellRange cells_reaching(const Level& level, const Vec3& low, const Vec3& high);

inline bool holds(const CellRange& range, const Cell (&cell)[3]) {
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    inside = inside && cell[axis] >= range.low[axis] && cell[axis] <= range.high[axis];
  }
  return inside;
}

/// Calls visit(entry) for entries of the row with x in [low_x, high_x] until it returns false.
template <typename Visit>
bool for_each_in_row(const Levels& levels, const Row& row, Cell low_x, Cell high_x, WalkCost& cost,
                     const Visit& visit) {
  ++cost.nodes;
  const auto first = levels.x_of_entry.begin() + row.begin;
  const auto last = levels.x_of_entry.begin() + row.end;
  auto place = static_cast<std::uint32_t>(std::lower_bound(first, last, low_x) - levels.x_of_entry.begin());
  for (; place < row.end && levels.x_of_entry[place] <= high_x; ++place) {
    if (!visit(levels.entries[place])) return false;
  }
  return true;
}

/// Calls visit(entry) for entries of the level whose cell is in the range, each once, until it returns false.
template <typename Visit>
bool for_each_in(const Levels& levels, const Level& level, const CellRange& range, WalkCost& cost,
                 const Visit& visit) {
  if (range.empty()) return true;
  if (range.row_count() >= static_cast<double>(level.row_end - level.row_begin)) {
    for (std::uint32_t i = level.row_begin; i < level.row_end; ++i) {
      const Row& row = levels.rows[i];
      const bool inside =
          row.y >= range.low[1] && row.y <= range.high[1] && row.z >= range.low[2] && row.z <= range.high[2];
      if (inside && !for_each_in_row(levels, row, range.low[0], range.high[0], cost, visit)) return false;
    }
    return true;
  }
  for (Cell z = range.low[2]; z <= range.high[2]; ++z) {
    for (Cell y = range.low[1]; y <= range.high[1]; ++y) {
      const std::uint32_t row = levels.find_row(level, y, z);
      if (row == kNoRow) continue;
      if (!for_each_in_row(levels, levels.rows[row], range.low[0], range.high[0], cost, visit)) return false;
    }
  }
  return true;
}

}  // namespace collided::grid
