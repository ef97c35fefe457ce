#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/world/events/contact_ledger.hpp"
#include "server/world/fences/fence_table.hpp"
#include "server/world/fences/nearer_search.hpp"
#include "server/world/fences/nearest_groups.hpp"
#include "server/world/step/pair_windows.hpp"

namespace collided::engine {

/// State of a standing question for the nearest object, as far as it is decided.
struct NearestProgress {
  std::uint32_t group = 0;
  ObjectId about = 0;        // its carrier at that time; 0: a point, or none
  bool is_begun = false;     // it was decided with this carrier
  bool has_nearest = false;  // there was a nearest at that time
  std::int64_t decided_ns = 0;
  double reach_m = 0;           // upper bound on the distance of the nearest at that time
  std::uint64_t cut_short = 0;  // searches so far that ended at their evaluation limit
};

/// Sources of a question's objects.
struct NearestSources {
  FenceTable& table;
  const MotionHistory& paths;  // starts at the time up to which the questions are decided
};

/// Decides the questions for the nearest object in one step: sends to the ledger which object is nearest, and since
/// when. Another object replaces the nearest once it is certainly nearer by the hysteresis; a tie is not enough. The
/// nearest ends without a successor once it is certainly beyond its reach.
class NearestDecisions {
 public:
  NearestDecisions(const StepView& step, const Grid& movers, const NearestSources& from, ContactLedger& ledger,
                   StepCost& cost)
      : step_(step),
        rows_(step.rows),
        movers_(movers),
        table_(from.table),
        paths_(from.paths),
        ledger_(ledger),
        cost_(cost) {}

  void decide(std::uint32_t fence, NearestProgress& question, const NearestGroup& group);

 private:
  static constexpr std::uint32_t kNone = FenceTable::kNone;

  /// A question during its decision. Objects are slots.
  struct NearestAsked {
    std::uint32_t fence = 0;
    NearestProgress& question;
    const NearestGroup& group;
    const NearestRule& rule;
    std::uint32_t about = kNone;    // kNone: a point
    std::uint32_t nearest = kNone;  // kNone: no object is near enough
  };
  struct Stretch {
    std::int64_t from_ns = 0;
    std::int64_t to_ns = 0;
  };
  struct Change {
    std::uint32_t to = kNone;
    BracketNs bracket;
    bool is_by_step = false;  // it happened when the step found it, as after the removal of the previous nearest
  };

  // The question as a whole.
  bool find_about(NearestAsked& asked) const;
  std::int64_t known_ns(const NearestAsked& asked) const;
  void begin(NearestAsked& asked, std::int64_t time_ns);
  void settle_what_came(NearestAsked& asked);
  bool may_change(const NearestAsked& asked, std::int64_t to_ns);
  void decide_pieces(NearestAsked& asked, std::int64_t to_ns);
  std::vector<std::int64_t> cuts(const NearestAsked& asked, std::int64_t to_ns) const;
  void decide_piece(NearestAsked& asked, Stretch piece);
  void decide_end(NearestAsked& asked, const BracketNs& last);
  void tell(NearestAsked& asked, const Change& change);
  std::int64_t clock_error_ns(const NearestAsked& asked, std::uint32_t other) const;
  const OpenContact* open_of(std::uint32_t fence) const;
  void note_reach(const NearestAsked& asked, std::int64_t time_ns);

  // Candidates for the nearest.
  bool may_be(const NearestAsked& asked, std::uint32_t slot) const;
  void find_candidates(const NearestAsked& asked, const Aabb& box);
  void order_found();
  Aabb bounds_about(const NearestAsked& asked, const Stretch& piece);
  double reach_m(const NearestAsked& asked, const Stretch& piece);
  std::uint32_t nearest_of_found(const NearestAsked& asked, std::int64_t time_ns);

  // Changes of the nearest.
  std::optional<Change> first_change(const NearestAsked& asked, const Stretch& piece);
  std::optional<BracketNs> first_time(const NearestAsked& asked, std::uint32_t nearer, const Stretch& piece,
                                      std::int64_t until_ns);
  std::optional<BracketNs> first_time_in_part(const NearestAsked& asked, std::uint32_t nearer, const Stretch& part);
  std::vector<std::int64_t> part_ends(const NearestAsked& asked, std::uint32_t nearer, const Stretch& piece) const;
  bool is_surely_nearer(const NearestAsked& asked, std::uint32_t nearer, std::int64_t time_ns);
  GapBounds gap_at(const NearestAsked& asked, std::uint32_t slot, std::int64_t time_ns, double limit_m);
  GapBody body(const NearestAsked& asked, std::uint32_t slot, const Stretch& part);
  Frame frame_at(std::uint32_t slot, std::int64_t time_ns) const;
  double off_m(std::uint32_t slot, std::int64_t time_ns) const;
  const ObjectInfo& info(const NearestAsked& asked, std::uint32_t slot);
  std::int64_t born_ns(std::uint32_t slot) const {
    return rows_.source(slot) == Sources::kResting ? 0 : rows_[slot].born_ns;
  }

  const StepView& step_;
  const ObjectRows& rows_;
  const Grid& movers_;
  FenceTable& table_;
  const MotionHistory& paths_;
  ContactLedger& ledger_;
  StepCost& cost_;
  WalkCost walk_;
  std::vector<std::uint32_t> found_;  // candidates, sorted by name
  std::int64_t cut_from_ns_ = 0;      // start of the time not covered by a cut-short search; kForEver: none
};

}  // namespace collided::engine
