#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/world/fences/clearings.hpp"
#include "server/world/fences/standing_decisions.hpp"
#include "server/world/fences/standing_nearest.hpp"

namespace collided::engine {

/// By name.
using Margins = std::map<std::string, FenceDefinition, std::less<>>;

/// The name of a band's fence: the names of the margin and of its object, the number of the band and its distance in
/// metres, each on a line of its own. No name contains a line feed.
std::string band_name(std::string_view margin, std::string_view about, std::size_t index, double within_m);

/// The fences of a world, the objects inside them, and the events of entry and exit. An object inside a fence is kept
/// like a contact: an event's a is the object, its b the fence; `began` means that the object entered, `ended` that it
/// left, with the reason.
/// threads  the writer only
class Fences {
 public:
  /// Returns the reason if the fence is refused.
  std::variant<ObjectId, Refusal> add(const FenceDefinition& definition);
  /// Objects inside leave with fence_removed at the next step. False: there is no such fence.
  bool remove(std::string_view name);
  /// The margins. They have no place of their own: each band around each object is a fence in the table.
  const Margins& margins() const { return margins_; }
  const FenceTable& table() const { return table_; }
  FenceTable& table() { return table_; }
  std::optional<ObjectId> find(std::string_view name) const;

  /// Changes of objects by a step: removed from the world with a reason, lost (true) or found again.
  struct Changes {
    std::span<const std::pair<ObjectId, EndReason>> removed;
    std::span<const std::pair<ObjectId, bool>> lost;
  };
  /// Drops the last step's events. Call it before the slots of removed objects are used again.
  void begin_step(std::int64_t world_time_ns, const Changes& changes);
  /// Decides everything that moved.
  ///
  /// movers  index over the motions of the step
  void decide(const StepView& step, const Grid& movers);
  void finish_step() { ledger_.finish_step(); }
  /// True if a fence must be decided though nothing moved.
  bool has_news() const { return !new_.empty() || !new_margins_.empty() || waits_for_time(); }
  /// True if time alone may cause an event though nothing moves: an entry or exit of a band, or a change of the
  /// nearest.
  bool waits_for_time() const { return is_any_pending() || nearest_.has_news(); }

  const std::vector<Event>& events() const { return ledger_.events(); }
  /// Which object is in which fence, including pairs in doubt, in no order.
  const std::vector<OpenContact>& inside() const { return ledger_.open(); }
  std::uint64_t last_sequence() const { return ledger_.last_sequence(); }
  std::size_t doubt_count() const { return ledger_.doubt_count(); }
  const StepCost& cost() const { return cost_; }
  /// Searches so far that ended at their evaluation limit: in total, and for one question for the nearest.
  std::uint64_t cut_short() const { return cut_short_; }
  std::uint64_t cut_short(std::uint32_t nearest) const { return nearest_.cut_short(nearest); }

 private:
  bool is_any_pending() const { return !pending_.empty(); }
  std::string reason_against(const FenceDefinition& definition) const;
  void remove_row(std::uint32_t fence);
  void drop_pending(ObjectId id);
  void make_bands(const StepView& step);
  void add_bands(const StepView& step, const FenceDefinition& margin, std::uint32_t object, bool is_new);
  void add_with_inner(std::uint32_t fence, std::vector<std::uint32_t>& to) const;
  Aabb bounds_around(std::uint32_t fence) const;
  void decide_pair(StandingDecisions& decisions, std::uint32_t fence, std::uint32_t mover, bool is_new);
  void decide_left_pending(const StepView& step, StandingDecisions& decisions);
  Aabb bounds_at(const StepView& step, std::uint32_t fence);
  void bind_waiting(const StepView& step);
  void bind(const StepView& step, std::uint32_t fence, std::uint32_t object);
  void follow_carriers(const StepView& step);
  Aabb bounds_on_the_way(const StepView& step, std::uint32_t fence);
  void gather_movers(const StepView& step);
  bool is_pending(const StepView& step, std::uint32_t slot) const;
  void find_fences_of(const StepView& step, std::uint32_t mover);
  void walk_fences(const StepView& step, std::uint32_t mover);
  void find_movers_of(const StepView& step, const Grid& movers, std::uint32_t fence);
  void keep_found_once();
  void consider(const StepView& step, StandingDecisions& decisions, std::uint32_t fence, std::uint32_t mover);

  FenceTable table_;
  Margins margins_;
  std::vector<std::string> new_margins_;  // since the last step
  PendingTurns pending_;
  std::uint64_t step_ = 0;
  ContactLedger ledger_{true};
  StandingNearest nearest_{table_, ledger_};
  StandingLists lists_;
  StepCost cost_;
  std::uint64_t cut_short_ = 0;
  std::vector<std::uint32_t> new_;  // fences added, or bound to their carrier, since the last step
  std::vector<ObjectId> removed_;   // since the last step
  Clearings clearings_;
  bool are_fences_still_ = false;  // in this step
  std::vector<std::uint32_t> movers_;
  std::vector<std::uint32_t> followed_;     // carried fences whose carrier moved or is not decided to its end
  std::vector<std::uint32_t> look_around_;  // fences that look for objects that do not look for them
  std::vector<std::uint32_t> with_inner_;   // a fence and the bands within it
  std::vector<std::uint32_t> found_;        // fences of an object, or objects of a fence
  WalkCost walk_;
};

}  // namespace collided::engine
