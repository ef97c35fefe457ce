#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/world/events/contact_ledger.hpp"
#include "server/world/fences/fence_table.hpp"
#include "server/world/fences/nearest_decisions.hpp"
#include "server/world/fences/nearest_groups.hpp"

namespace collided::engine {

/// The questions that stay for the nearest object. Each is a fence without bounds: in the ledger a is the object that is
/// nearest and b the question.
///
/// A question is decided up to the time at which all objects that it looks at are known, in pieces between the instants
/// of their publishers; so its events follow from definitions and poses alone.
/// threads  the writer's only
class StandingNearest {
 public:
  StandingNearest(FenceTable& table, ContactLedger& ledger) : table_(table), ledger_(ledger) {}

  void add(std::uint32_t fence);
  void remove(std::uint32_t fence);
  bool empty() const { return questions_.empty(); }
  /// A motion, or a question, may not be decided though nothing moves now.
  bool has_news() const { return has_new_ || !paths_.history().travelling().empty(); }
  /// How many searches of a question ended at their limit of looks, so that who came and went may not have been told.
  std::uint64_t cut_short(std::uint32_t fence) const;
  /// movers  index over the motions of the step
  void decide(const StepView& step, const Grid& movers, StepCost& cost);

 private:
  void follow_paths(const StepView& step);

  FenceTable& table_;
  ContactLedger& ledger_;
  std::map<std::uint32_t, NearestProgress> questions_;  // by fence
  NearestGroups groups_;
  NearestPaths paths_;
  bool has_new_ = false;
};

}  // namespace collided::engine
