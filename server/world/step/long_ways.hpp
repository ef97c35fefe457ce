#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/world/step/step_view.hpp"

namespace collided::engine {

/// The path of an object that moved in this step. Nothing if it was placed, or if other times than this step's are
/// undecided for it, so that only its whole bounds help.
std::optional<StraightWay> way_of(const StepView& step, std::uint32_t slot);

/// Best number of parts for the path of one object; 1: its bounds are hardly larger than the object.
std::uint32_t parts_of(const StraightWay& way);

/// Finds the pairs of a step in which objects make long moves: a box around a long path is mostly empty, and those of a
/// crowd all overlap. Divides the step's time into equal parts, and compares the short boxes within each part.
///
/// threads  the writer
class LongWays {
 public:
  explicit LongWays(const StepView& step) : step_(step) {}

  /// Best number of parts for this step; 1: no division. Estimated from a sample of the movers.
  ///
  /// boxes  number of boxes in the index
  std::uint32_t part_count(std::size_t boxes) const;
  /// Finds the pairs (first < second) whose boxes overlap in one of the parts, each once, except pairs at rest. `found`
  /// returns false to end the search.
  void pairs(std::uint32_t parts, Grid::PairFound found, WalkCost& cost);

 private:
  void find_in_part(double begin, double end, WalkCost& cost);
  void keep_each_once();

  const StepView& step_;
  std::vector<std::uint32_t> slots_;  // of the objects with a path
  std::vector<StraightWay> ways_;
  std::vector<Aabb> boxes_;
  std::vector<std::uint64_t> found_;  // first slot in the high half
  std::size_t most_unsorted_ = 0;
};

}  // namespace collided::engine
