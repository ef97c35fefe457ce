#include "server/world/fences/standing_nearest.hpp"

namespace collided::engine {

void StandingNearest::add(std::uint32_t fence) {
  questions_.emplace(fence, NearestProgress{.group = groups_.take(table_.rule(fence))});
  has_new_ = true;
}

void StandingNearest::remove(std::uint32_t fence) {
  const auto found = questions_.find(fence);
  if (found == questions_.end()) return;
  groups_.release(found->second.group);
  questions_.erase(found);
  if (questions_.empty()) paths_ = {};
}

void StandingNearest::decide(const StepView& step, const Grid& movers, StepCost& cost) {
  if (questions_.empty()) return;
  groups_.follow(step);
  follow_paths(step);
  NearestDecisions decisions(step, movers, {table_, paths_.history()}, ledger_, cost);
  for (auto& [fence, question] : questions_) {
    const std::uint32_t before = cost.sweeps_skipped;
    decisions.decide(fence, question, groups_[question.group]);
    question.cut_short += cost.sweeps_skipped - before;
  }
  // No source needs an earlier time.
  paths_.forget_up_to(step.sources.floor_ns());
  has_new_ = false;
}

std::uint64_t StandingNearest::cut_short(std::uint32_t fence) const {
  const auto found = questions_.find(fence);
  return found == questions_.end() ? 0 : found->second.cut_short;
}

/// Follows all objects of the questions: what the step still knows about newly monitored objects, and what is new about
/// the others.
void StandingNearest::follow_paths(const StepView& step) {
  const auto follow = [&](std::uint32_t slot) {
    const bool is_there = step.rows.info(slot) != nullptr;
    if (is_there && (groups_.is_any_of(slot) || !table_.carried_by(slot).empty())) paths_.follow(step, slot);
    else paths_.forget(slot);
  };
  for (const std::uint32_t slot : step.rows.moved()) follow(slot);
  if (!has_new_) return;
  for (std::uint32_t slot = 0; slot < step.rows.size(); ++slot) {
    if (!paths_.is_followed(slot) && step.rows.source(slot) != Sources::kResting) follow(slot);
  }
}

}  // namespace collided::engine
