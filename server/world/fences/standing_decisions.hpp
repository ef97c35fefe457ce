#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "server/world/events/contact_ledger.hpp"
#include "server/world/fences/band_predicate.hpp"
#include "server/world/fences/fence_table.hpp"
#include "server/world/fences/region_predicate.hpp"
#include "server/world/fences/standing_piece.hpp"
#include "server/world/step/pair_windows.hpp"

namespace collided::engine {

/// An object enters or leaves.
struct Turn {
  bool comes_in = false;
  BracketNs bracket;
  FoundContact found;                    // without its bracket
  std::uint64_t considered_in_step = 0;  // for a pending one
};

/// Turns that have not lasted long enough to be reported, by object and fence.
using PendingTurns = std::map<std::pair<ObjectId, ObjectId>, Turn>;

/// Decides objects and fences in one step: sends to the ledger which object is in a fence, and which entered or left.
/// It divides the newly known time of the two into pieces of motion, and in each piece asks the predicate of the
/// fence's form when it starts and stops to hold: RegionPredicate or BandPredicate. An object and a fence in the world
/// need no common time: the fence is known for ever. A carried fence has the time of its carrier.
class StandingDecisions {
 public:
  StandingDecisions(const StepView& step, FenceTable& table, ContactLedger& ledger, StandingLists& lists,
                    PendingTurns& pending, StepCost& cost)
      : step_(step),
        rows_(step.rows),
        table_(table),
        ledger_(ledger),
        lists_(lists),
        pending_(pending),
        cost_(cost),
        regions_(step, table, lists, cost),
        bands_(step, table, cost) {}

  /// True if the fence monitors this object: its rule matches, and the object is not its carrier.
  bool looks_at(std::uint32_t fence, std::uint32_t mover) const;
  /// For an object inside: true if it certainly still is. A filter: false means unknown.
  bool surely_stays(std::uint32_t fence, std::uint32_t mover) { return regions_.surely_holds(fence, mover); }
  /// Decides all newly known time of the two.
  ///
  /// is_new  the fence was added, or bound to its carrier, since the last step: only the object's current place counts
  void decide(std::uint32_t fence, std::uint32_t mover, bool is_new);
  /// Marks that the pending turn of the two, if there is one, was decided in this step.
  void note_considered(std::uint32_t fence, std::uint32_t mover, std::uint64_t step);
  /// Reports the turns that have lasted for their dwell by the time up to which both objects are known.
  void settle();

 private:
  using Pending = PendingTurns::iterator;
  /// How the stay of an object ends that was inside and no longer is.
  struct Departure {
    EndReason reason = EndReason::none;
    BracketNs bracket;
  };

  bool band_looks_at(std::uint32_t fence, const ObjectInfo& mover) const;

  // Pieces of the newly known time.
  void decide_at_rest_in_the_world(std::uint32_t fence, std::uint32_t mover);
  void decide_carried(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier);
  void decide_on_common_time(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier);
  void decide_new(std::uint32_t fence, std::uint32_t mover);
  StandingPiece instant_on(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier, std::int64_t time_ns) const;
  StandingPiece instant_now(std::uint32_t fence, std::uint32_t mover, std::int64_t time_ns) const;
  void decide_piece(const StandingPiece& piece);
  void decide_instant(const StandingPiece& instant, const Departure& left);

  // Turns in one piece, by the predicate of the fence's form.
  template <class Predicate>
  void decide_piece_of(Predicate& predicate, const StandingPiece& piece);
  template <class Predicate>
  void decide_instant_of(Predicate& predicate, const StandingPiece& instant, const Departure& left);
  template <class Predicate>
  Decision decision_at_end(Predicate& predicate, const StandingPiece& piece, bool was_in);
  void decide_turns(RegionPredicate& region, const StandingPiece& piece, bool was_in);
  void decide_turns(BandPredicate& band, const StandingPiece& piece, bool was_in);
  void report_times(RegionPredicate& region, const StandingPiece& piece, bool was_in);
  template <class Predicate>
  void decide_one_in(Predicate& predicate, const StandingPiece& piece, Decision at_end);
  template <class Predicate>
  void decide_one_out(Predicate& predicate, const StandingPiece& piece, Decision at_end,
                      const typename Predicate::Time& first);
  template <class Predicate>
  void come_in(Predicate& predicate, const StandingPiece& piece, Decision at_end,
               const typename Predicate::Time& first);
  template <class Predicate>
  void go_out(Predicate& predicate, const StandingPiece& piece);
  template <class Predicate>
  Turn coming_in(Predicate& predicate, const StandingPiece& piece, const typename Predicate::Time& first);

  // Reporting turns.
  void turn(const StandingPiece& piece, const Turn& turned, EndReason reason);
  bool outlasts(const StandingPiece& piece, Pending here, const Turn& next);
  void report(ObjectId a, ObjectId b, const Turn& turned, EndReason reason);
  void report_crossing(const Turn& came, const BracketNs& left, Doubt doubt);
  void doubt(const StandingPiece& piece, Doubt why);
  void end_doubt(const StandingPiece& piece, const BracketNs& apart);

  Pending pending_of(const StandingPiece& piece);
  bool is_in(const StandingPiece& piece);
  bool may_begin();
  FoundContact found_in(const StandingPiece& piece) const;
  FoundContact found_at(const Turn& turned) const;
  BracketNs whole(const StandingPiece& piece) const;
  BracketNs bracket_of(const StandingPiece& piece, const TurnTime& time) const;
  std::int64_t clock_error_ns(const StandingPiece& piece) const;
  std::int64_t known_ns(ObjectId mover, std::uint32_t fence) const;

  const StepView& step_;
  const ObjectRows& rows_;
  FenceTable& table_;
  ContactLedger& ledger_;
  StandingLists& lists_;
  PendingTurns& pending_;
  StepCost& cost_;
  RegionPredicate regions_;
  BandPredicate bands_;
};

}  // namespace collided::engine
