#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/world/step/step_view.hpp"

namespace collided::engine {

/// The way of an object that moved in this step; nothing where it was placed, or other times than this step's are still to
/// be decided of it, so that only the bounds of all of them serve.
std::optional<StraightWay> way_of(const StepView& step, std::uint32_t slot);

/// In how many parts the way of one object is best looked at; 1: its bounds are hardly larger than the object.
std::uint32_t parts_of(const StraightWay& way);

/// Finds the pairs of a step in which objects leap: a box around a long way is mostly empty, and all of a crowd's overlap.
/// The step's time is cut into equal parts, and within each the boxes of that part are compared, which are short.
///
/// threads  the writer's
class LongWays {
 public:
  explicit LongWays(const StepView& step) : step_(step) {}

  /// Into how many parts this step is best cut; 1: not at all. Judged by some of what moved.
  ///
  /// boxes  how many there are in the index
  std::uint32_t part_count(std::size_t boxes) const;
  /// The pairs (first < second) whose boxes overlap in one of the parts, each once, but for those at rest. `found` returns
  /// false to end the search.
  void pairs(std::uint32_t parts, Grid::PairFound found, WalkCost& cost);

 private:
  void find_in_part(double begin, double end, WalkCost& cost);
  void keep_each_once();

  const StepView& step_;
  std::vector<std::uint32_t> slots_;  // of what has a way
  std::vector<StraightWay> ways_;
  std::vector<Aabb> boxes_;
  std::vector<std::uint64_t> found_;  // first in the high half
  std::size_t most_unsorted_ = 0;
};

}  // namespace collided::engine
