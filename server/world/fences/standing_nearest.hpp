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

/// The standing questions for the nearest object. Each is a fence without bounds: in the ledger a is the nearest object
/// and b the question.
///
/// A question is decided up to the time at which all its monitored objects are known, in pieces between the instants of
/// their publishers, so its events follow from definitions and poses alone.
/// threads  the writer only
class StandingNearest {
 public:
  StandingNearest(FenceTable& table, ContactLedger& ledger) : table_(table), ledger_(ledger) {}

  void add(std::uint32_t fence);
  void remove(std::uint32_t fence);
  bool empty() const { return questions_.empty(); }
  /// True if a motion or a question may be undecided though nothing moves now.
  bool has_news() const { return has_new_ || !paths_.history().travelling().empty(); }
  /// Number of a question's searches that ended at their evaluation limit, so that changes of the nearest may be
  /// missing.
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
