#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/world/fences/fence.hpp"
#include "server/world/step/step_view.hpp"

namespace collided::engine {

/// The objects monitored by questions for the nearest with one name glob, layers and exceptions.
struct NearestGroup {
  std::string only;
  std::string skip;
  std::uint32_t mask = 0;
  std::uint32_t question_count = 0;
  std::vector<ObjectId> members = {};       // by slot; 0: not a member
  std::vector<std::uint32_t> sources = {};  // sources whose time the members have, each once; resting ones have none
  std::vector<std::uint32_t> came = {};     // slots of members new in this step
  std::vector<std::uint32_t> young = {};    // members that began after the time up to which all questions are decided

  bool holds(std::uint32_t slot) const { return slot < members.size() && members[slot] != 0; }
  bool is_of(const FenceRule& rule) const { return rule.only == only && rule.skip == skip && rule.mask == mask; }
};

/// The groups of all standing questions, each once.
/// threads  the writer only
class NearestGroups {
 public:
  /// Returns the number of the rule's group, and counts one more question in it.
  std::uint32_t take(const FenceRule& rule);
  void release(std::uint32_t group);
  /// Updates the members from the rows; new groups examine all rows.
  void follow(const StepView& step);

  NearestGroup& operator[](std::uint32_t group) { return groups_[group]; }
  /// True if some group contains it.
  bool is_any_of(std::uint32_t slot) const;
  template <class Visit>
  void for_each(Visit&& visit) {
    for (NearestGroup& group : groups_) {
      if (group.question_count > 0) visit(group);
    }
  }

 private:
  void look_at_all(const StepView& step, NearestGroup& group);
  void look_at_changes(const StepView& step, NearestGroup& group);
  void look_at(const StepView& step, NearestGroup& group, std::uint32_t slot);

  std::vector<NearestGroup> groups_;     // including free ones
  std::vector<std::uint32_t> new_ones_;  // since the last step
};

/// The motions of objects since the time up to which the questions are decided. Written like MotionHistory in
/// StepMotion, but always for these objects, and kept as long as any question waits.
class NearestPaths {
 public:
  /// Takes what is known about the object at the end of this step.
  void follow(const StepView& step, std::uint32_t slot);
  void forget(std::uint32_t slot);
  void forget_up_to(std::int64_t time_ns) { history_.forget_up_to(time_ns); }
  const MotionHistory& history() const { return history_; }
  bool is_followed(std::uint32_t slot) const { return slot < is_followed_.size() && is_followed_[slot] != 0; }

 private:
  MotionHistory history_;
  std::vector<std::uint8_t> is_followed_;  // by slot
};

}  // namespace collided::engine
