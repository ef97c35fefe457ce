#pragma once

#include <algorithm>

#include "server/broad_phase/grid/grid.hpp"
#include "server/broad_phase/grid/grid_levels.hpp"

namespace collided::engine::grid {

/// The walks of Grid over its levels. Pairs use SIMD, chosen at run time.
void find_pairs(const Levels& levels, Grid::PairFound found, WalkCost& cost);
void walk_box(const Levels& levels, const Aabb& asked, Grid::BoxFound found, WalkCost& cost);
void walk_ray(const Levels& levels, const Ray& ray, double limit, Grid::RayFound found, WalkCost& cost);
void walk_near(const Levels& levels, const Vec3& point, double limit_m2, Grid::NearFound found, WalkCost& cost);

/// Cells with boxes that may reach [low, high], within the occupied ones; may be empty (low > high on some axis).
CellRange cells_reaching(const GridLevel& level, const Vec3& low, const Vec3& high);

inline bool holds(const CellRange& range, const Cell (&cell)[3]) {
  bool inside = true;
  for (int axis = 0; axis < 3; ++axis) {
    inside = inside && cell[axis] >= range.low[axis] && cell[axis] <= range.high[axis];
  }
  return inside;
}

/// A range of cells in the numbers of a level's axes; skips unoccupied cells if the level does not number them.
struct NumberRange {
  std::uint64_t low[3];
  std::uint64_t high[3];

  NumberRange(const GridLevel& level, const CellRange& cells) {
    for (int k = 0; k < 3; ++k) {
      low[k] = level.axes[k].at_least(cells.low[k]);
      high[k] = level.axes[k].at_most(cells.high[k]);
    }
  }
  bool empty() const { return low[0] > high[0] || low[1] > high[1] || low[2] > high[2]; }
  /// Number of rows, that is of (y, z); a double, because it may exceed any integer.
  double row_count() const {
    return static_cast<double>(high[1] - low[1] + 1) * static_cast<double>(high[2] - low[2] + 1);
  }
  bool holds(const GridLevel& level, Key key) const {
    const std::uint64_t number[3] = {key & ((Key{1} << level.y_shift) - 1),
                                     key >> level.y_shift & ((Key{1} << (level.z_shift - level.y_shift)) - 1),
                                     key >> level.z_shift};
    bool inside = true;
    for (int k = 0; k < 3; ++k) inside = inside && number[k] >= low[k] && number[k] <= high[k];
    return inside;
  }
};

/// Calls visit_row(first, last) with the first and last key of each row in the range; false ends the visit.
template <typename VisitRow>
bool for_each_row_in(const GridLevel& level, const NumberRange& range, WalkCost& cost, const VisitRow& visit_row) {
  for (std::uint64_t z = range.low[2]; z <= range.high[2]; ++z) {
    for (std::uint64_t y = range.low[1]; y <= range.high[1]; ++y) {
      ++cost.nodes;
      if (!visit_row(level.key(range.low[0], y, z), level.key(range.high[0], y, z))) return false;
    }
  }
  return true;
}

/// Calls visit(entry) for each entry of the level whose cell is in the range, once; false ends the visit.
template <typename Visit>
bool for_each_in(const Levels& levels, const GridLevel& level, const CellRange& cells, WalkCost& cost,
                 const Visit& visit) {
  if (cells.empty()) return true;
  const NumberRange range(level, cells);
  if (range.empty()) return true;
  if (range.row_count() * 4 < static_cast<double>(level.count())) {
    return for_each_row_in(level, range, cost, [&](Key first, Key last) {
      for (std::uint32_t place = levels.first_place(level, first); levels.keys[place] <= last; ++place) {
        if (!visit(levels.entry(place))) return false;
      }
      return true;
    });
  }
  ++cost.nodes;
  for (std::uint32_t place = level.begin; place < level.end; ++place) {
    if (range.holds(level, levels.keys[place]) && !visit(levels.entry(place))) return false;
  }
  return true;
}

}  // namespace collided::engine::grid
