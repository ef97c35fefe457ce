#include "server/world/step/shared_decisions.hpp"

#include <utility>

#include "server/geometry/float_environment.hpp"
#include "server/world/step/candidates.hpp"

namespace collided::engine {
namespace {

void add_counts(const StepCost& part, StepCost& cost) {
  for (const auto count :
       {&StepCost::candidate_pairs, &StepCost::exact_tests, &StepCost::undecided, &StepCost::swept, &StepCost::filtered,
        &StepCost::kept_apart, &StepCost::sweeps_skipped, &StepCost::sweep_looks, &StepCost::contacts})
    cost.*count += part.*count;
}

}  // namespace

SharedDecisions::SharedDecisions(const StepView& step, ContactLedger& ledger, SeparationCache& apart,
                                 DecisionLists& lists, StepCost& cost, StepPool* pool, StepBlocks& blocks)
    : step_(step), ledger_(ledger), apart_(apart), lists_(lists), cost_(cost), pool_(pool), blocks_(blocks) {}

bool SharedDecisions::add(const StepItem& item) {
  if (is_over_) return false;
  if (begun_ == 0 || blocks_[begun_ - 1].items.size() == StepBlock::kMost) {
    if (begun_ == blocks_.size() && !settle()) return false;
    blocks_[begun_++].clear();
  }
  StepBlock& block = blocks_[begun_ - 1];
  block.items.push_back(item);
  if (block.items.size() < StepBlock::kMost) return true;
  if (!std::exchange(is_begun_, true)) {
    pool_->begin_step([this](StepBlock& one, DecisionLists& lists) { decide(one, lists); }, step_.rows.size());
  }
  pool_->push(block);
  return true;
}

bool SharedDecisions::settle() {
  if (begun_ == 0) return !is_over_;
  if (blocks_[begun_ - 1].items.size() < StepBlock::kMost) decide(blocks_[begun_ - 1], lists_);
  if (is_begun_) pool_->finish(lists_);
  for (std::size_t i = 0; i < begun_ && !is_over_; ++i) {
    if (may_reach_limits(blocks_[i])) is_over_ = !decide_again(blocks_[i]);
    else apply(blocks_[i]);
  }
  begun_ = 0;
  return !is_over_;
}

/// True if one thread may have reached a limit at any item of the block: that of contacts, of candidates, or of tests
/// along motions. The latter counts as reached once fewer tests are left than one search may make.
bool SharedDecisions::may_reach_limits(const StepBlock& block) const {
  const std::uint64_t most = step_.options.max_contacts;
  const std::uint64_t contacts = std::uint64_t{cost_.contacts} + block.cost.contacts;
  const std::uint64_t candidates = std::uint64_t{cost_.candidate_pairs} + block.items.size();
  const bool is_short_of_looks =
      block.cost.sweep_looks > 0 && !Decisions::are_looks_free(cost_.sweep_looks + block.cost.sweep_looks);
  return cost_.truncated || contacts >= most || ledger_.open().size() + block.writes.size() >= most ||
         candidates >= Decisions::kCandidatesAContact * most || is_short_of_looks;
}

void SharedDecisions::apply(const StepBlock& block) {
  for (const LedgerWrite& change : block.writes) write(change, ledger_);
  for (const GapFound& found : block.gaps) apart_.note(found);
  add_counts(block.cost, cost_);
}

void SharedDecisions::decide(StepBlock& block, DecisionLists& lists) const {
  const OwnFloatEnvironment own_floats;
  Decisions decisions(step_, ledger_, apart_, lists, block.cost, &block);
  Candidates(step_, decisions, block.cost).decide(block.items);
}

bool SharedDecisions::decide_again(const StepBlock& block) {
  Decisions decisions(step_, ledger_, apart_, lists_, cost_);
  return Candidates(step_, decisions, cost_).decide(block.items);
}

}  // namespace collided::engine
