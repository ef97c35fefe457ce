#pragma once

#include <cstdint>
#include <map>
#include <utility>

#include "server/world/events/contact_ledger.hpp"
#include "server/world/fences/fence_piece.hpp"
#include "server/world/fences/fence_table.hpp"
#include "server/world/fences/gap_search.hpp"
#include "server/world/step/pair_windows.hpp"

namespace collided::engine {

/// An object that came into a band, or left it, too short a time ago to be told.
struct PendingTurn {
  bool comes_in = false;
  BracketNs bracket;   // of the turn
  FoundContact found;  // of one that came in; without its bracket
  std::uint64_t considered_in_step = 0;
};

/// By object and band.
using PendingTurns = std::map<std::pair<ObjectId, ObjectId>, PendingTurn>;

/// What one step decides of objects and bands: as FenceDecisions, by distances. An object comes in at the band's
/// distance, and goes out beyond it and the hysteresis; either is told once it has lasted for the dwell.
class BandDecisions {
 public:
  BandDecisions(const StepView& step, const FenceTable& table, ContactLedger& ledger, PendingTurns& pending,
                StepCost& cost)
      : step_(step), rows_(step.rows), table_(table), ledger_(ledger), pending_(pending), cost_(cost) {}

  void decide_piece(const FencePiece& piece);
  /// left: how it ends if the object was in and is not any more.
  void decide_instant(const FencePiece& instant, const ContactEnd& left);
  /// What is pending of the two was decided in this step.
  void note_considered(std::uint32_t fence, std::uint32_t mover, std::uint64_t step);
  /// Tells what has lasted for its dwell by the time up to which both objects are known.
  void settle();

 private:
  using Pending = PendingTurns::iterator;

  const BandRule& rule(const FencePiece& piece) const { return *table_.rule(piece.fence).band; }
  Pending pending_of(const FencePiece& piece);
  bool is_in(const FencePiece& piece);
  bool may_be_near(const FencePiece& piece) const;
  Decision within_at_end(const FencePiece& piece, const GapLimit& limit);
  GapTime first_within(const FencePiece& piece, const GapLimit& limit, double from = 0);
  GapTime first_beyond(const FencePiece& piece, const GapLimit& limit, double from);
  GapOptions options_of(const FencePiece& piece, double from);
  bool may_turn_back(const FencePiece& piece) const;
  void decide_turns(const FencePiece& piece);
  void decide_end(const FencePiece& piece, bool is_in_now, double from, const GapTime& last);
  void decide_one_that_is_in(const FencePiece& piece);
  void decide_one_that_is_out(const FencePiece& piece);
  void come_in(const FencePiece& piece, const GapTime& first, Decision at_end);
  void go_out(const FencePiece& piece);
  void turn(const FencePiece& piece, const PendingTurn& turned, EndReason reason);
  bool outlasts(const FencePiece& piece, const PendingTurn& next);
  void doubt(const FencePiece& piece, Doubt why);
  void tell(ObjectId a, ObjectId b, const PendingTurn& turned, EndReason reason);
  FoundContact found_in(const FencePiece& piece) const;
  FoundContact found_at(const FencePiece& piece, const GapTime& first);
  void predict(const FencePiece& piece, double t, FoundContact& found);
  BracketNs in_nanoseconds(const FencePiece& piece, const GapTime& time, bool is_reversed) const;
  std::int64_t clock_error_ns(const FencePiece& piece) const;
  std::int64_t known_ns(ObjectId mover, std::uint32_t fence) const;
  bool may_begin();

  const StepView& step_;
  const ObjectRows& rows_;
  const FenceTable& table_;
  ContactLedger& ledger_;
  PendingTurns& pending_;
  StepCost& cost_;
  WalkCost walk_;
};

}  // namespace collided::engine
