#include "server/broad_phase/grid/grid_walk.hpp"

#include <algorithm>
#include <cmath>

namespace collided::engine::grid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Relative slack on computed parameters and squares: a few roundings of 2^-53 each.
constexpr double kRelative = 0x1p-49;
/// Absolute slack where results underflow.
constexpr double kLeast = 16 * std::numeric_limits<double>::denorm_min();

/// The parameters at which a ray may be within [low, high]; empty where entry > exit. Zero components are decided by
/// comparison; an overflow leaves the axis unrestricted.
struct SlabSpan {
  double entry = 0;
  double exit = 0;
};

void clip(const Ray& ray, int axis, double low, double high, SlabSpan& span) {
  const double o = ray.origin[axis];
  const double d = ray.direction[axis];
  if (d == 0) {
    if (o < low || o > high) span.exit = -1;
    return;
  }
  const double to_near = (d > 0 ? low : high) - o;
  const double to_far = (d > 0 ? high : low) - o;
  if (std::isfinite(to_near)) {
    const double entry = to_near / d;
    if (std::isfinite(entry)) span.entry = std::max(span.entry, entry - kRelative * std::abs(entry) - kLeast);
  }
  if (std::isfinite(to_far)) {
    const double exit = to_far / d;
    if (std::isfinite(exit)) span.exit = std::min(span.exit, exit + kRelative * std::abs(exit) + kLeast);
  }
}

SlabSpan clip(const Ray& ray, const Entry& entry, double limit) {
  SlabSpan span{0, limit};
  for (int axis = 0; axis < 3; ++axis) clip(ray, axis, entry.low(axis), entry.high(axis), span);
  return span;
}

/// Whether the entry may lie within the limit. A square may overflow only at a distance that no limit below 1e307
/// reaches.
bool is_within(const Entry& entry, const Vec3& point, double limit_m2) {
  double square = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double away = std::max({entry.low(axis) - point[axis], point[axis] - entry.high(axis), 0.0});
    square += away * away;
  }
  return limit_m2 >= 1e307 || square * (1 - kRelative) <= limit_m2;
}

double clamped(double cell, Cell low, Cell high) {
  return std::clamp(cell, static_cast<double>(low), static_cast<double>(high) + 1);
}

/// A ray's walk over one level: slabs perpendicular to y or z, whichever the ray crosses faster, cut into blocks along
/// x; near to far. A box belongs to the slab and block of its own cell, so none is visited twice.
class SlabWalk {
 public:
  SlabWalk(const Levels& levels, const GridLevel& level, const Ray& ray, WalkCost& cost)
      : levels_(levels),
        level_(level),
        ray_(ray),
        cost_(cost),
        main_(std::abs(ray.direction[1]) > std::abs(ray.direction[2]) ? 1 : 2) {}

  /// visit(entry, limit) returns the new limit.
  template <typename Visit>
  double walk(double limit, const Visit& visit) {
    SlabSpan span{0, limit};
    for (int axis = 0; axis < 3; ++axis) clip(ray_, axis, level_.bounds.low[axis], level_.bounds.high[axis], span);
    if (!(span.entry <= span.exit)) return limit;
    const CellRange reached = reach(span);
    if (!is_sharp(span) || !is_short(reached)) return in_range(level_.occupied, limit, visit);
    Slice slab{main_, reached.low[main_], reached.high[main_], ray_.direction[main_] >= 0, 1};
    for (; limit >= 0 && slab.next();) {
      SlabSpan here{span.entry, std::min(span.exit, limit)};
      if (!clip_to(slab, here)) continue;
      limit = walk_blocks(slab, here, limit, visit);
    }
    return limit;
  }

 private:
  /// Cells [from, from + width) of one axis, starting on the ray's side.
  struct Slice {
    int axis;
    Cell low;
    Cell high;
    bool forward;
    Cell width;
    Cell from = 0;
    bool started = false;

    bool next() {
      if (!started) {
        from = forward ? low : high - width + 1;
        started = true;
      } else {
        from += forward ? width : -width;
      }
      return forward ? from <= high : from + width > low;
    }
  };

  template <typename Visit>
  double walk_blocks(const Slice& slab, const SlabSpan& span, double limit, const Visit& visit) const {
    constexpr Cell kBlock = 16;
    const CellRange reached = reach(span);
    Slice block{0, reached.low[0], reached.high[0], ray_.direction[0] >= 0, kBlock};
    while (limit >= 0 && block.next()) {
      SlabSpan here{span.entry, std::min(span.exit, limit)};
      if (!clip_to(block, here)) continue;
      CellRange range = reach(here);
      range.low[0] = std::max(block.from, reached.low[0]);
      range.high[0] = std::min(block.from + kBlock - 1, reached.high[0]);
      range.low[slab.axis] = range.high[slab.axis] = slab.from;
      limit = in_range(range, limit, visit);
    }
    return limit;
  }

  /// Restricts the span to where the ray may meet boxes with cells in the slice: these end less than a cell beyond it.
  bool clip_to(const Slice& slice, SlabSpan& span) const {
    const double cell_m = level_.cell_m[slice.axis];
    const double low = static_cast<double>(slice.from) * cell_m - margin(slice.axis);
    const double high = static_cast<double>(slice.from + slice.width + 1) * cell_m + margin(slice.axis);
    clip(ray_, slice.axis, low, high, span);
    return span.entry <= span.exit;
  }

  double margin(int axis) const { return 0x1p-8 * level_.cell_m[axis]; }

  /// Whether points along the ray are known to within 2^-9 of a cell, half the margin.
  bool is_sharp(const SlabSpan& span) const {
    const double largest = std::max({ray_.origin.cwiseAbs().maxCoeff(), level_.bounds.high.cwiseAbs().maxCoeff(),
                                     level_.bounds.low.cwiseAbs().maxCoeff()});
    return largest * 0x1p-41 < level_.cell_m.minCoeff() && std::isfinite(span.entry);
  }

  /// Whether looking up cells along the ray costs less than visiting every row.
  bool is_short(const CellRange& reached) const {
    const double slabs = static_cast<double>(reached.high[main_] - reached.low[main_]) + 1;
    const double blocks = static_cast<double>(reached.high[0] - reached.low[0]) / 16;
    return 4 * (slabs + blocks) < static_cast<double>(level_.count());
  }

  /// Cells with boxes that the ray may meet within the span.
  CellRange reach(const SlabSpan& span) const {
    Vec3 lowest;
    Vec3 highest;
    for (int axis = 0; axis < 3; ++axis) {
      const double d = ray_.direction[axis];
      const double at_entry = d == 0 ? 0 : d * span.entry;
      const double at_exit = d == 0 ? 0 : d * span.exit;
      lowest[axis] = ray_.origin[axis] + std::min(at_entry, at_exit) - margin(axis);
      highest[axis] = ray_.origin[axis] + std::max(at_entry, at_exit) + margin(axis);
    }
    return cells_reaching(level_, lowest, highest);
  }

  template <typename Visit>
  double in_range(const CellRange& range, double limit, const Visit& visit) const {
    for_each_in(levels_, level_, range, cost_, [&](const Entry& entry) {
      const SlabSpan span = clip(ray_, entry, limit);
      if (span.entry <= span.exit) limit = visit(entry, limit);
      return limit >= 0;
    });
    return limit;
  }

  const Levels& levels_;
  const GridLevel& level_;
  const Ray& ray_;
  WalkCost& cost_;
  int main_;
};

/// One level's walk outward from a point, in boxes that double in size until nothing nearer can remain.
template <typename Visit>
double walk_near_level(const Levels& levels, const GridLevel& level, const Vec3& point, double limit_m2, WalkCost& cost,
                       const Visit& visit) {
  double radius = level.cell_m.maxCoeff();
  for (int axis = 0; axis < 3; ++axis) {
    radius = std::max({radius, level.bounds.low[axis] - point[axis], point[axis] - level.bounds.high[axis]});
  }
  CellRange before{{1, 1, 1}, {0, 0, 0}};
  while (limit_m2 >= 0) {
    // Slightly more than the limit, so that nothing within it is lost.
    const double enough = limit_m2 >= 1e307 ? kInfinity : std::sqrt(limit_m2) * (1 + kRelative) + kLeast;
    const double reached = std::min(radius * (1 + kRelative), enough * (1 + kRelative));
    const CellRange range = cells_reaching(level, point.array() - reached * (1 + kRelative) - kLeast,
                                           point.array() + reached * (1 + kRelative) + kLeast);
    for_each_in(levels, level, range, cost, [&](const Entry& entry) {
      const Cell cell[3] = {level.cell_of(0, entry.low(0)), level.cell_of(1, entry.low(1)),
                            level.cell_of(2, entry.low(2))};
      if (is_within(entry, point, limit_m2) && !holds(before, cell)) limit_m2 = visit(entry, limit_m2);
      return limit_m2 >= 0;
    });
    bool all = true;
    for (int axis = 0; axis < 3; ++axis) {
      all = all && range.low[axis] <= level.occupied.low[axis] && range.high[axis] >= level.occupied.high[axis];
    }
    if (all || reached >= enough) break;
    before = range;
    radius *= 2;
  }
  return limit_m2;
}

}  // namespace

CellRange cells_reaching(const GridLevel& level, const Vec3& low, const Vec3& high) {
  CellRange range;
  for (int axis = 0; axis < 3; ++axis) {
    const Cell first = level.occupied.low[axis];
    const Cell last = level.occupied.high[axis];
    // Clamped while still doubles, because queries may be infinite.
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
  const auto visit = [&](const Entry& entry, double current) {
    ++cost.candidates;
    return found(entry.box(), current);
  };
  for (std::uint32_t i = levels.loose_begin; i < levels.loose_end && limit >= 0; ++i) {
    const SlabSpan span = clip(ray, levels.entry(i), limit);
    if (span.entry <= span.exit) limit = visit(levels.entry(i), limit);
  }
  for (const GridLevel& level : levels.levels) {
    if (limit >= 0) limit = SlabWalk(levels, level, ray, cost).walk(limit, visit);
  }
}

void walk_near(const Levels& levels, const Vec3& point, double limit_m2, Grid::NearFound found, WalkCost& cost) {
  if (!(limit_m2 >= 0)) return;
  const auto visit = [&](const Entry& entry, double current) {
    ++cost.candidates;
    return found(entry.box(), current);
  };
  for (std::uint32_t i = levels.loose_begin; i < levels.loose_end && limit_m2 >= 0; ++i) {
    if (is_within(levels.entry(i), point, limit_m2)) limit_m2 = visit(levels.entry(i), limit_m2);
  }
  for (const GridLevel& level : levels.levels) {
    if (limit_m2 >= 0) limit_m2 = walk_near_level(levels, level, point, limit_m2, cost, visit);
  }
}

}  // namespace collided::engine::grid
