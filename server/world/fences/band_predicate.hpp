#pragma once

#include <cstdint>

#include "server/world/events/contact_ledger.hpp"
#include "server/world/fences/fence_table.hpp"
#include "server/world/fences/gap_search.hpp"
#include "server/world/fences/standing_piece.hpp"
#include "server/world/step/step_view.hpp"

namespace collided::engine {

/// Whether an object is within a band of another one, by their distance. It enters at the band's distance, and leaves
/// beyond that distance plus the hysteresis.
class BandPredicate {
 public:
  using Time = GapTime;
  /// A band that an object passes within one piece has an event for each of the two changes.
  static constexpr bool kReportsCrossings = false;
  static constexpr bool kForgetsEntry = false;

  BandPredicate(const StepView& step, const FenceTable& table, StepCost& cost)
      : rows_(step.rows), table_(table), cost_(cost) {}

  /// A filter: false means that the object is not inside at any time of the piece.
  bool may_hold(const StandingPiece& piece) const;
  /// True if the object may enter or leave more than once in the piece.
  bool may_turn_back(const StandingPiece& piece) const;
  Decision at_end(const StandingPiece& piece, bool was_in);
  /// For an object that entered within the piece and is not certainly inside at its end: true if it is outside there.
  bool is_out_at_end(const StandingPiece& piece, Decision) { return at_end(piece, true) == Decision::no; }
  /// The first time from `from` on at which an object outside enters, or one inside leaves.
  GapTime first_within(const StandingPiece& piece, double from = 0);
  GapTime first_beyond(const StandingPiece& piece, double from);
  /// When an object that is outside at the end was last inside.
  GapTime last_within(const StandingPiece& piece);
  /// Adds where the two are nearest, how far apart, their relative velocity, and when they would touch.
  void describe(const StandingPiece& piece, const GapTime& first, FoundContact& found);
  void describe_instant(const StandingPiece& instant, FoundContact& found) {
    describe(instant, first_within(instant), found);
  }

 private:
  const BandRule& rule(const StandingPiece& piece) const { return *table_.rule(piece.fence).band; }
  GapOptions options_of(const StandingPiece& piece, double from);
  GapBody body_of(std::uint32_t slot, const BodyMotion& motion) const;
  GapTime first_within(const StandingPiece& piece, const GapLimit& limit, double from);
  void predict(const StandingPiece& piece, double t, FoundContact& found);

  const ObjectRows& rows_;
  const FenceTable& table_;
  StepCost& cost_;
  WalkCost walk_;
};

inline TurnTime turn_time(const GapTime& found) { return {found.bracket, found.at.on_a, found.at.normal}; }

}  // namespace collided::engine
