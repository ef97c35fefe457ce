#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/world/fences/fence.hpp"
#include "server/world/step/step_view.hpp"

namespace collided::engine {

/// The objects that standing questions for the nearest look at: those of one name glob, layers and exceptions.
struct NearestGroup {
  std::string only;
  std::string skip;
  std::uint32_t mask = 0;
  std::uint32_t question_count = 0;
  std::vector<ObjectId> members = {};       // by slot; 0: it is none
  std::vector<std::uint32_t> sources = {};  // whose time they have, each once; resting ones have none
  std::vector<std::uint32_t> came = {};     // slots of those that are new in this step
  std::vector<std::uint32_t> young = {};  // slots of those that began after the time that is decided for every question

  bool holds(std::uint32_t slot) const { return slot < members.size() && members[slot] != 0; }
  bool is_of(const FenceRule& rule) const { return rule.only == only && rule.skip == skip && rule.mask == mask; }
};

/// The groups of all standing questions, each once.
/// threads  the writer's only
class NearestGroups {
 public:
  /// The number of the rule's group, which one question more has.
  std::uint32_t take(const FenceRule& rule);
  void release(std::uint32_t group);
  /// Brings the members up to date with the rows; new groups look at all of them.
  void follow(const StepView& step);

  NearestGroup& operator[](std::uint32_t group) { return groups_[group]; }
  /// Some group holds it.
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

  std::vector<NearestGroup> groups_;     // some of them free
  std::vector<std::uint32_t> new_ones_;  // since the last step
};

/// The motions of objects from the time on to which the questions are decided; written like MotionHistory in StepMotion,
/// but for these objects in every case, and for as long as any question waits.
class NearestPaths {
 public:
  /// Takes what is known of the object at the end of this step.
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
