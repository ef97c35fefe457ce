#pragma once

#include <array>
#include <cstddef>

#include "server/world/step/step_pool.hpp"

namespace collided::engine {

/// The items of a step that all its threads decide, in blocks at the same time, each against the ledger as it was
/// before. Then the blocks are applied in order, so that ledger, events and costs equal those of a single thread. If a
/// limit of the whole step may have been reached within a block, its items are decided again, one by one.
///
/// threads  the world's
class SharedDecisions {
 public:
  /// lists  with this step's boxes
  SharedDecisions(const StepView& step, ContactLedger& ledger, SeparationCache& apart, DecisionLists& lists,
                  StepCost& cost, StepPool* pool, StepBlocks& blocks);

  /// True if there are enough items to wake the other threads.
  bool is_worth(std::size_t decided) const { return decided >= step_.options.step_alone; }
  /// Adds an item. False: a limit of the step is reached, and its search ends.
  bool add(const StepItem& item);
  /// Decides and applies all added items. False as in add().
  bool settle();

 private:
  bool may_reach_limits(const StepBlock& block) const;
  void apply(const StepBlock& block);
  void decide(StepBlock& block, DecisionLists& lists) const;
  bool decide_again(const StepBlock& block);

  const StepView& step_;
  ContactLedger& ledger_;
  SeparationCache& apart_;
  DecisionLists& lists_;
  StepCost& cost_;
  StepPool* const pool_;
  StepBlocks& blocks_;
  std::size_t begun_ = 0;  // blocks with items
  bool is_begun_ = false;  // the pool has begun this step
  bool is_over_ = false;   // there is no room for more
};

}  // namespace collided::engine
