#pragma once

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

inline bool is_empty(const CellRange& range) {
  return range.low[0] > range.high[0] || range.low[1] > range.high[1] || range.low[2] > range.high[2];
}

/// Lookups that a visit of the range costs; as a double, since it may exceed any integer.
inline double row_count(const CellRange& range) {
  double rows = static_cast<double>((range.high[0] >> kRowBits) - (range.low[0] >> kRowBits)) + 1;
  for (int axis = 1; axis < 3; ++axis) {
    rows *= static_cast<double>(range.high[axis] - range.low[axis]) + 1;
  }
  return rows;
}

/// Calls visit(entry) for entries of the level whose cell is in the range, each once, until it returns false.
/// Tables are shared by cells whose hashes collide; test decides first, as it is cheaper than finding the cell.
template <typename Test, typename Visit>
bool for_each_in(const Levels& levels, const Level& level, const CellRange& range, WalkCost& cost, const Test& test,
                 const Visit& visit) {
  if (is_empty(range)) return true;
  const auto in_range = [&](const Entry& entry) {
    const Cell cell[3] = {level.cell_of(entry.low(0)), level.cell_of(entry.low(1)), level.cell_of(entry.low(2))};
    return holds(range, cell);
  };
  const Entry* entries = levels.entries.data();
  if (row_count(range) >= static_cast<double>(level.count())) {
    ++cost.nodes;
    for (std::uint32_t i = level.begin; i < level.end; ++i) {
      if (test(entries[i]) && in_range(entries[i]) && !visit(entries[i])) return false;
    }
    return true;
  }
  for (Cell z = range.low[2]; z <= range.high[2]; ++z) {
    for (Cell y = range.low[1]; y <= range.high[1]; ++y) {
      for (Cell x = range.low[0]; x <= range.high[0];) {
        const Cell last = std::min(x | kRowMask, range.high[0]);
        const std::uint32_t bucket = level.bucket(x, y, z);
        const std::uint32_t end = levels.starts[bucket + static_cast<std::uint32_t>(last - x) + 1];
        const CellRange here{{x, y, z}, {last, y, z}};
        ++cost.nodes;
        for (std::uint32_t i = levels.starts[bucket]; i < end; ++i) {
          const Entry& entry = entries[i];
          if (!test(entry)) continue;
          const Cell cell[3] = {level.cell_of(entry.low(0)), level.cell_of(entry.low(1)),
                                level.cell_of(entry.low(2))};
          if (holds(here, cell) && !visit(entry)) return false;
        }
        x = last + 1;
      }
    }
  }
  return true;
}

}  // namespace collided::grid
