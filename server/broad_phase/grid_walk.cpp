#include "server/broad_phase/grid_walk.hpp"

#include <algorithm>
#include <cmath>

namespace collided::grid {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// Relative slack on computed parameters and squares: a handful of roundings of 2^-53 each.
constexpr double kRelative = 0x1p-49;
/// Absolute slack where results underflow.
constexpr double kLeast = 16 * std::numeric_limits<double>::denorm_min();

/// The parameters at which a ray may be within [low, high]; empty while entry > exit. Zero components are decided by
/// comparison; whatever overflows leaves the axis open.
struct Span {
  double entry = 0;
  double exit = 0;
};

void clip(const Ray& ray, int axis, double low, double high, Span& span) {
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
    span.exit = std::min(span.exit, exit + kRelative * std::abs(exit) + kLeast);
  }
}

Span clip(const Ray& ray, const Entry& entry, double limit) {
  Span span{0, limit};
  for (int axis = 0; axis < 3; ++axis) clip(ray, axis, entry.low(axis), entry.high(axis), span);
  return span;
}

/// At least the largest double would be needed for a square that overflows: nothing is out of such a limit's reach.
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

/// The ray's walk over one level: slabs of two cells' thickness across its main axis, near to far. A box belongs to
/// the slab of its own cell, so none is visited twice.
class SlabWalk {
 public:
  SlabWalk(const Levels& levels, const Level& level, const Ray& ray, WalkCost& cost)
      : levels_(levels), level_(level), ray_(ray), cost_(cost) {
    ray.direction.cwiseAbs().maxCoeff(&main_);
  }

  /// visit(entry) returns the new limit.
  template <typename Visit>
  double walk(double limit, const Visit& visit) {
    Span span{0, limit};
    for (int axis = 0; axis < 3; ++axis) clip(ray_, axis, level_.bounds.low[axis], level_.bounds.high[axis], span);
    if (!(span.entry <= span.exit)) return limit;
    CellRange range = level_.occupied;
    const bool forward = ray_.direction[main_] > 0;
    const double rows = 9 * (static_cast<double>(range.high[main_] - range.low[main_]) + 1);
    if (rows >= static_cast<double>(level_.count()) || !is_sharp(span)) return in_range(range, limit, visit);
    const Cell first = forward ? range.low[main_] : range.high[main_];
    const Cell last = forward ? range.high[main_] : range.low[main_];
    const Cell step = forward ? 1 : -1;
    for (Cell slab = first; slab != last + step && limit >= 0; slab += step) {
      Span here{span.entry, std::min(span.exit, limit)};
      const double low = static_cast<double>(slab) * level_.cell_m;
      const double margin = 0x1p-8 * level_.cell_m;
      clip(ray_, main_, low - margin, low + 2 * level_.cell_m + margin, here);
      if (!(here.entry <= here.exit)) continue;
      Vec3 lowest;
      Vec3 highest;
      reach(here, margin, lowest, highest);
      range = cells_reaching(level_, lowest, highest);
      range.low[main_] = range.high[main_] = slab;
      limit = in_range(range, limit, visit);
    }
    return limit;
  }

 private:
  /// Whether points along the way are known to 2^-9 of a cell, half the margin.
  bool is_sharp(const Span& span) const {
    double largest = 0;
    for (int axis = 0; axis < 3; ++axis) {
      largest = std::max(largest, std::abs(ray_.origin[axis]));
      largest = std::max(largest, level_.bounds.high.cwiseAbs().maxCoeff());
      largest = std::max(largest, level_.bounds.low.cwiseAbs().maxCoeff());
    }
    return largest * 0x1p-41 < level_.cell_m && std::isfinite(span.entry);
  }

  void reach(const Span& span, double margin, Vec3& lowest, Vec3& highest) const {
    for (int axis = 0; axis < 3; ++axis) {
      const double d = ray_.direction[axis];
      const double at_entry = d == 0 ? 0 : d * span.entry;
      const double at_exit = d == 0 ? 0 : d * span.exit;
      lowest[axis] = ray_.origin[axis] + std::min(at_entry, at_exit) - margin;
      highest[axis] = ray_.origin[axis] + std::max(at_entry, at_exit) + margin;
    }
  }

  template <typename Visit>
  double in_range(const CellRange& range, double limit, const Visit& visit) const {
    const auto test = [&](const Entry& entry) {
      const Span span = clip(ray_, entry, limit);
      return span.entry <= span.exit;
    };
    for_each_in(levels_, level_, range, cost_, test, [&](const Entry& entry) {
      limit = visit(entry, limit);
      return limit >= 0;
    });
    return limit;
  }

  const Levels& levels_;
  const Level& level_;
  const Ray& ray_;
  WalkCost& cost_;
  int main_ = 0;
};

/// One level's walk outward from a point, in boxes that double until nothing nearer can be left.
template <typename Visit>
double walk_near_level(const Levels& levels, const Level& level, const Vec3& point, double limit_m2, WalkCost& cost,
                       const Visit& visit) {
  double radius = level.cell_m;
  for (int axis = 0; axis < 3; ++axis) {
    radius = std::max({radius, level.bounds.low[axis] - point[axis], point[axis] - level.bounds.high[axis]});
  }
  CellRange before{{1, 1, 1}, {0, 0, 0}};
  while (limit_m2 >= 0) {
    // A little more than the limit asks, never more than what is left.
    const double enough = limit_m2 >= 1e307 ? kInfinity : std::sqrt(limit_m2) * (1 + kRelative) + kLeast;
    const double reached = std::min(radius * (1 + kRelative), enough * (1 + kRelative));
    const CellRange range = cells_reaching(level, point.array() - reached * (1 + kRelative) - kLeast,
                                           point.array() + reached * (1 + kRelative) + kLeast);
    const auto test = [&](const Entry& entry) {
      const Cell cell[3] = {level.cell_of(entry.low(0)), level.cell_of(entry.low(1)), level.cell_of(entry.low(2))};
      return is_within(entry, point, limit_m2) && !holds(before, cell);
    };
    for_each_in(levels, level, range, cost, test, [&](const Entry& entry) {
      limit_m2 = visit(entry, limit_m2);
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

CellRange cells_reaching(const Level& level, const Vec3& low, const Vec3& high) {
  CellRange range;
  for (int axis = 0; axis < 3; ++axis) {
    const Cell first = level.occupied.low[axis];
    const Cell last = level.occupied.high[axis];
    // Clamped while still doubles: questions may be infinite.
    range.low[axis] = static_cast<Cell>(clamped(std::floor((low[axis] - level.cell_m) * level.inverse), first, last));
    range.high[axis] = static_cast<Cell>(
        std::clamp(std::floor(high[axis] * level.inverse), static_cast<double>(first) - 1, static_cast<double>(last)));
  }
  return range;
}

void walk_box(const Levels& levels, const Aabb& asked, Grid::BoxFound found, void* context, WalkCost& cost) {
  if (asked.empty()) return;
  const auto overlaps_asked = [&](const Entry& entry) {
    bool all = true;
    for (int axis = 0; axis < 3; ++axis) {
      all = all && entry.low(axis) <= asked.high[axis] && asked.low[axis] <= entry.high(axis);
    }
    return all;
  };
  const auto visit = [&](const Entry& entry) {
    ++cost.candidates;
    return found(context, entry.box());
  };
  for (std::uint32_t i = levels.loose_begin; i < levels.entry_count; ++i) {
    if (overlaps_asked(levels.entries[i]) && !visit(levels.entries[i])) return;
  }
  for (const Level& level : levels.levels) {
    if (!for_each_in(levels, level, cells_reaching(level, asked.low, asked.high), cost, overlaps_asked, visit)) return;
  }
}

void walk_ray(const Levels& levels, const Ray& ray, double limit, Grid::RayFound found, void* context,
              WalkCost& cost) {
  if (!(limit >= 0)) return;
  const auto visit = [&](const Entry& entry, double current) {
    ++cost.candidates;
    return found(context, entry.box(), current);
  };
  for (std::uint32_t i = levels.loose_begin; i < levels.entry_count && limit >= 0; ++i) {
    const Span span = clip(ray, levels.entries[i], limit);
    if (span.entry <= span.exit) limit = visit(levels.entries[i], limit);
  }
  for (const Level& level : levels.levels) {
    if (limit >= 0) limit = SlabWalk(levels, level, ray, cost).walk(limit, visit);
  }
}

void walk_near(const Levels& levels, const Vec3& point, double limit_m2, Grid::NearFound found, void* context,
               WalkCost& cost) {
  if (!(limit_m2 >= 0)) return;
  const auto visit = [&](const Entry& entry, double current) {
    ++cost.candidates;
    return found(context, entry.box(), current);
  };
  for (std::uint32_t i = levels.loose_begin; i < levels.entry_count && limit_m2 >= 0; ++i) {
    if (is_within(levels.entries[i], point, limit_m2)) limit_m2 = visit(levels.entries[i], limit_m2);
  }
  for (const Level& level : levels.levels) {
    if (limit_m2 >= 0) limit_m2 = walk_near_level(levels, level, point, limit_m2, cost, visit);
  }
}

}  // namespace collided::grid
