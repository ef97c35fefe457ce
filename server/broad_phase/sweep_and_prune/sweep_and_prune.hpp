#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/broad_phase/box_block.hpp"
#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/aabb.hpp"

namespace collided::engine {

/// Sweep-and-prune along one axis: keeps boxes in the order of their low ends from frame to frame, so that little
/// motion needs little sorting. Generous, never misses. Worthwhile if boxes are few or lie along a line: all pairs that
/// overlap on the axis are compared.
/// threads  one updates; while none does, any number may walk
/// source   Cohen, Lin, Manocha and Ponamgi, "I-COLLIDE", 1995, on one axis instead of three
class SweepAndPrune {
 public:
  /// About the last update. A swap moves one box past another.
  struct Report {
    int axis = 0;
    std::uint64_t swaps = 0;
    bool is_sorted_anew = false;  // the last frame's order could not be used
  };

  /// Boxes are numbered by their index in the span; empty ones are left out. Keeps its memory and, if the same boxes
  /// are non-empty, its order.
  void update(std::span<const Aabb> boxes);

  void clear();

  std::size_t size() const { return order_.size(); }
  /// The number of the box at a place in the order.
  std::uint32_t number(std::uint32_t place) const { return order_[place].number; }
  std::size_t bytes() const;
  const Report& report() const { return report_; }

  /// All pairs (first < second) of overlapping boxes, touching included, each once, in no particular order. `found`
  /// returns false to end the walk.
  using PairFound = FunctionRef<bool(std::uint32_t first, std::uint32_t second)>;
  void pairs(PairFound found, WalkCost& cost) const;

 private:
  struct Place {
    double low;
    std::uint32_t number;
  };

  int best_axis(std::span<const Aabb> boxes) const;
  void start_anew(std::span<const Aabb> boxes, int axis);
  bool sort_from_last();

  std::vector<Place> order_;      // ascending by low end
  std::vector<BoxBlock> blocks_;  // in that order; NaN after the last
  std::vector<std::uint32_t> numbers_;
  std::size_t box_count_ = 0;  // in the last update, including empty ones
  Report report_;
};

}  // namespace collided::engine
