#pragma once

#include <array>
#include <cstddef>

#include "server/world/step/step_pool.hpp"

namespace collided::engine {

/// The items of a step that all its threads decide: in blocks, at once, each against the ledger as it was before. Then the
/// blocks are applied in their order, so that ledger, events and costs are those of one thread that decides one item after
/// the other. Where a limit of the whole step may have come up within a block, its items are decided again, one after the
/// other.
///
/// threads  the world's
class SharedDecisions {
 public:
  /// lists  with this step's boxes
  SharedDecisions(const StepView& step, ContactLedger& ledger, SeparationCache& apart, DecisionLists& lists,
                  StepCost& cost, StepPool* pool, StepBlocks& blocks);

  /// Whether there are so many items that it pays to wake the other threads.
  bool is_worth(std::size_t decided) const { return decided >= step_.options.step_alone; }
  /// Hands an item over. False: the step has found all that it may, and ends its search.
  bool add(const StepItem& item);
  /// Decides and applies all that was handed over. False as in add().
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
  bool is_begun_ = false;  // the pool knows of this step
  bool is_over_ = false;   // there is no room for more
};

}  // namespace collided::engine
