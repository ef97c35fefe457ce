#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/world/step/shared_decisions.hpp"

namespace collided::engine {

/// The candidates of one step: passes each pair whose motions' bounds may meet to the decisions, once.
class Candidates {
 public:
  /// shared  takes candidates once there is much to decide; null: all are decided here
  Candidates(const StepView& step, Decisions& decisions, StepCost& cost, SharedDecisions* shared = nullptr)
      : step_(step), rows_(step.rows), decisions_(decisions), cost_(cost), shared_(shared) {}

  /// Passes on movers and static scenes.
  void decide_scenes();
  /// Passes on pairs of objects; the grid must be built over the motions' bounds.
  void decide_pairs(const Grid& grid);
  /// Decides a block's items in their order. False: there is no room for more.
  bool decide(std::span<const StepItem> items);

 private:
  /// Movers such that every pair to test contains one of them: those that moved, or all if a static object was placed.
  struct QueryMovers {
    std::vector<std::uint32_t> slots;
    bool all = false;
  };
  /// Candidates whose data is being prefetched: neighbours in space are far apart in memory.
  struct Waiting {
    static constexpr std::size_t kSize = 32;
    std::array<std::pair<std::uint32_t, std::uint32_t>, kSize> pairs;
    std::size_t count = 0;
  };

  QueryMovers find_query_movers() const;
  /// Deciding a mover against a scene, or a pair of other shapes, takes about as long as this many pairs of balls.
  static constexpr std::size_t kShapeWeight = 4;
  static constexpr std::size_t kSceneWeight = 16;
  static constexpr std::size_t kMeshWeight = 32;

  bool are_balls(std::uint32_t first, std::uint32_t second) const {
    return step_.motion.ball(first).radius_m >= 0 && step_.motion.ball(second).radius_m >= 0;
  }
  bool decide_scene(std::uint32_t mover, std::size_t scene);
  void look_whether_worth_sharing() { is_shared_ = shared_ != nullptr && shared_->is_worth(decided_); }
  bool look_around(const Grid& grid, std::uint32_t mover, bool all_look);
  void look_along(const Grid& grid, const StraightWay& way, std::uint32_t parts, Grid::BoxFound found);
  bool wait_for(std::uint32_t first, std::uint32_t second);
  bool consider_waiting();
  bool consider(std::uint32_t first, std::uint32_t second);

  const StepView& step_;
  const ObjectRows& rows_;
  Decisions& decisions_;
  StepCost& cost_;
  SharedDecisions* const shared_;
  bool is_shared_ = false;
  std::size_t decided_ = 0;  // weighted number of pairs
  WalkCost walk_;
  Waiting waiting_;
};

}  // namespace collided::engine
