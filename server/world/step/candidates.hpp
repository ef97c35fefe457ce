#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/world/step/decisions.hpp"

namespace collided::engine {

/// The candidates of one step: offers each pair whose motions may meet by their bounds to the decisions, once.
class Candidates {
 public:
  Candidates(const StepView& step, Decisions& decisions, StepCost& cost)
      : step_(step), rows_(step.rows), decisions_(decisions), cost_(cost) {}

  /// Offers movers and static scenes.
  void decide_scenes();
  /// Offers pairs of objects; the grid must be built over the motions' bounds.
  void decide_pairs(const Grid& grid);

 private:
  /// Movers such that every pair to be tested contains one of them: those that moved, or all of them where something
  /// was placed that does not move.
  struct QueryMovers {
    std::vector<std::uint32_t> slots;
    bool all = false;
  };
  /// Candidates whose data is being prefetched: objects that are neighbours in space are far apart in memory.
  struct Waiting {
    static constexpr std::size_t kSize = 32;
    std::array<std::pair<std::uint32_t, std::uint32_t>, kSize> pairs;
    std::size_t count = 0;
  };

  QueryMovers find_query_movers() const;
  bool look_around(const Grid& grid, std::uint32_t mover, bool all_look);
  bool wait_for(std::uint32_t first, std::uint32_t second);
  bool consider_waiting();
  bool consider(std::uint32_t first, std::uint32_t second);

  const StepView& step_;
  const ObjectRows& rows_;
  Decisions& decisions_;
  StepCost& cost_;
  WalkCost walk_;
  Waiting waiting_;
};

}  // namespace collided::engine
