#include "server/broad_phase/grid/grid_walk.hpp"

#include <algorithm>
#include <cmath>

#include "server/broad_phase/box_tests.hpp"

namespace collided::engine::grid {
namespace {

double clamped(double cell, Cell low, Cell high) {
  return std::clamp(cell, static_cast<double>(low), static_cast<double>(high) + 1);
}

/// Calls visit(entry) for each box; false ends the visit.
template <typename Visit>
void for_each(const Levels& levels, const Visit& visit) {
  const auto in_places = [&](std::uint32_t from, std::uint32_t to) {
    for (std::uint32_t place = from; place < to; ++place) {
      if (!visit(levels.entry(place))) return false;
    }
    return true;
  };
  if (!in_places(levels.loose_begin, levels.loose_end)) return;
  for (const GridLevel& level : levels.levels) {
    if (!in_places(level.begin, level.end)) return;
  }
}

}  // namespace

CellRange cells_reaching(const GridLevel& level, const Vec3& low, const Vec3& high) {
  CellRange range;
  for (int axis = 0; axis < 3; ++axis) {
    const Cell first = level.occupied.low[axis];
    const Cell last = level.occupied.high[axis];
    // Clamped before the conversion to integers, because queries may be infinite.
    range.low[axis] =
        static_cast<Cell>(clamped(std::floor((low[axis] - level.cell_m[axis]) * level.inverse[axis]), first, last));
    range.high[axis] = static_cast<Cell>(std::clamp(std::floor(high[axis] * level.inverse[axis]),
                                                    static_cast<double>(first) - 1, static_cast<double>(last)));
  }
  return range;
}

void walk_box(const Levels& levels, const Aabb& asked, Grid::BoxFound found, WalkCost& cost) {
  if (asked.empty()) return;
  const auto overlaps_asked = [&](const Entry& entry) {
    bool all = true;
    for (int axis = 0; axis < 3; ++axis) {
      all = all && entry.low(axis) <= asked.high[axis] && asked.low[axis] <= entry.high(axis);
    }
    return all;
  };
  const auto visit = [&](const Entry& entry) {
    if (!overlaps_asked(entry)) return true;
    ++cost.candidates;
    return found(entry.box());
  };
  for (std::uint32_t i = levels.loose_begin; i < levels.loose_end; ++i) {
    if (!visit(levels.entry(i))) return;
  }
  for (const GridLevel& level : levels.levels) {
    if (!for_each_in(levels, level, cells_reaching(level, asked.low, asked.high), cost, visit)) return;
  }
}

void walk_ray(const Levels& levels, const Ray& ray, double limit, Grid::RayFound found, WalkCost& cost) {
  if (!(limit >= 0)) return;
  if (levels.tree) return levels.tree->walk_ray(ray, limit, found, cost);
  const auto visit = [&](const Entry& entry) {
    const SlabSpan span = clip(ray, entry, limit);
    if (!(span.entry <= span.exit)) return true;
    ++cost.candidates;
    limit = found(entry.box(), limit);
    return limit >= 0;
  };
  for_each(levels, visit);
}

void walk_near(const Levels& levels, const Vec3& point, double limit_m2, Grid::NearFound found, WalkCost& cost) {
  if (!(limit_m2 >= 0)) return;
  if (levels.tree) return levels.tree->walk_near(point, limit_m2, found, cost);
  const auto visit = [&](const Entry& entry) {
    if (!is_within(entry, point, limit_m2)) return true;
    ++cost.candidates;
    limit_m2 = found(entry.box(), limit_m2);
    return limit_m2 >= 0;
  };
  for_each(levels, visit);
}

}  // namespace collided::engine::grid
