#include "server/world/fences/nearest_groups.hpp"

#include <algorithm>

#include "idl/glob.hpp"

namespace collided::engine {
namespace {

bool looks_at(const NearestGroup& group, const ObjectInfo& object) {
  // Parts of a scene share one mesh, and have no body of their own to measure distances from.
  if (object.scene_part != kNoScenePart || (object.filter.layers & group.mask) == 0) return false;
  if (!group.skip.empty() && wire_contract::glob_matches(group.skip, object.name)) return false;
  return wire_contract::glob_matches(group.only, object.name);
}

void gather_sources(const StepView& step, NearestGroup& group) {
  group.sources.clear();
  for (std::uint32_t slot = 0; slot < group.members.size(); ++slot) {
    if (!group.holds(slot) || step.rows.source(slot) == Sources::kResting) continue;
    const std::uint32_t source = step.rows.source(slot);
    if (std::find(group.sources.begin(), group.sources.end(), source) == group.sources.end())
      group.sources.push_back(source);
  }
  std::sort(group.sources.begin(), group.sources.end());
}

}  // namespace

std::uint32_t NearestGroups::take(const FenceRule& rule) {
  const auto is_free = [](const NearestGroup& group) { return group.question_count == 0; };
  auto found = std::find_if(groups_.begin(), groups_.end(),
                            [&](const NearestGroup& group) { return !is_free(group) && group.is_of(rule); });
  if (found == groups_.end()) {
    found = std::find_if(groups_.begin(), groups_.end(), is_free);
    if (found == groups_.end()) found = groups_.emplace(groups_.end());
    *found = NearestGroup{.only = rule.only, .skip = rule.skip, .mask = rule.mask};
    new_ones_.push_back(static_cast<std::uint32_t>(found - groups_.begin()));
  }
  ++found->question_count;
  return static_cast<std::uint32_t>(found - groups_.begin());
}

void NearestGroups::release(std::uint32_t group) {
  if (--groups_[group].question_count > 0) return;
  groups_[group] = NearestGroup{};
  std::erase(new_ones_, group);
}

bool NearestGroups::is_any_of(std::uint32_t slot) const {
  return std::any_of(groups_.begin(), groups_.end(), [&](const NearestGroup& group) { return group.holds(slot); });
}

void NearestGroups::follow(const StepView& step) {
  for (std::uint32_t number = 0; number < groups_.size(); ++number) {
    NearestGroup& group = groups_[number];
    if (group.question_count == 0) continue;
    const bool is_new = std::find(new_ones_.begin(), new_ones_.end(), number) != new_ones_.end();
    is_new ? look_at_all(step, group) : look_at_changes(step, group);
    group.young.insert(group.young.end(), group.came.begin(), group.came.end());
    std::erase_if(group.young, [&](std::uint32_t slot) {
      return !group.holds(slot) || step.rows[slot].born_ns <= step.sources.floor_ns();
    });
  }
  new_ones_.clear();
}

void NearestGroups::look_at_all(const StepView& step, NearestGroup& group) {
  for (std::uint32_t slot = 0; slot < step.rows.size(); ++slot) look_at(step, group, slot);
  // Its questions are new, and examine all members in any case.
  group.came.clear();
  gather_sources(step, group);
}

void NearestGroups::look_at_changes(const StepView& step, NearestGroup& group) {
  group.came.clear();
  bool is_changed = false;
  for (const std::uint32_t slot : step.rows.moved()) {
    const ObjectInfo* info = step.rows.info(slot);
    const bool is_same = info != nullptr && group.holds(slot) && group.members[slot] == info->id;
    // An object that is attached to another takes the time of that one's publisher, and is marked as new.
    is_changed = is_changed || (group.holds(slot) && (!is_same || step.rows.is_new(slot)));
    if (!is_same) look_at(step, group, slot);
  }
  if (is_changed || !group.came.empty()) gather_sources(step, group);
}

void NearestGroups::look_at(const StepView& step, NearestGroup& group, std::uint32_t slot) {
  const ObjectInfo* info = step.rows.info(slot);
  const bool is_member = info != nullptr && looks_at(group, *info);
  if (slot >= group.members.size()) {
    if (!is_member) return;
    group.members.resize(step.rows.size());
  }
  group.members[slot] = is_member ? info->id : 0;
  if (is_member) group.came.push_back(slot);
}

namespace {

MotionSegment way_of_step(const StepView& step, std::uint32_t slot) {
  return segment_of(step.rows, slot, step.sources[step.rows.source(slot)], step.rows.bounds(slot),
                    step.motion.bounds()[slot]);
}

}  // namespace

void NearestPaths::follow(const StepView& step, std::uint32_t slot) {
  if (slot >= is_followed_.size()) is_followed_.resize(step.rows.size());
  if (is_followed_[slot] != 0 && !step.rows.is_new(slot)) {
    if (step.rows.is_posed(slot) && step.rows.source(slot) != Sources::kResting)
      history_.add(slot, way_of_step(step, slot));
    return;
  }
  // What the step still knows about it, including this step's motion.
  history_.forget(slot);
  is_followed_[slot] = 1;
  if (step.motion.history().is_travelling(slot)) {
    step.motion.history().for_each(slot, [&](const MotionSegment& segment) { history_.add(slot, segment); });
  } else if (step.rows.is_posed(slot) && step.rows.source(slot) != Sources::kResting) {
    history_.add(slot, way_of_step(step, slot));
  }
}

void NearestPaths::forget(std::uint32_t slot) {
  history_.forget(slot);
  if (slot < is_followed_.size()) is_followed_[slot] = 0;
}

}  // namespace collided::engine
