#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "server/world/events/contact_ledger.hpp"
#include "server/world/fences/fence_table.hpp"
#include "server/world/fences/standing_piece.hpp"
#include "server/world/objects/contact_times.hpp"
#include "server/world/step/piece_points.hpp"
#include "server/world/step/step_view.hpp"

namespace collided::engine {

/// Lists reused from step to step.
struct StandingLists {
  PiecePoints mover_points;
  PiecePoints fence_points;
  std::vector<std::int64_t> cuts;
  ContactTimes times;  // of the surfaces of the current pair, in the current piece
};

/// Whether an object is in a region: they touch, or one, a solid mesh, contains some of the other. Decided by the tests
/// and sweeps that decide contacts.
///
/// Pieces are decided one after another: find_times() and is_in_after() read what at_end() found.
class RegionPredicate {
 public:
  using Time = SweptContact;
  /// An object that enters and leaves within one piece is reported as having crossed the region.
  static constexpr bool kReportsCrossings = true;
  /// Once an instant shows the object inside, the contact of its entry is dropped.
  static constexpr bool kForgetsEntry = true;

  RegionPredicate(const StepView& step, FenceTable& table, StandingLists& lists, StepCost& cost)
      : step_(step), rows_(step.rows), table_(table), lists_(lists), cost_(cost) {}

  /// For an object inside a fixed region: true if it certainly still is. A filter: false means unknown.
  bool surely_holds(std::uint32_t fence, std::uint32_t mover);
  /// A filter: false means that the object is not inside at any time of the piece.
  bool may_hold(const StandingPiece& piece);
  /// True if the object may enter or leave more than once in the piece.
  bool may_turn_back(const StandingPiece& piece);
  Decision at_end(const StandingPiece& piece, bool was_in);
  /// For an object that entered within the piece and is not certainly inside at its end: true if it is outside there.
  bool is_out_at_end(const StandingPiece&, Decision at_end) { return at_end == Decision::no; }
  SweptContact first_within(const StandingPiece& piece);
  SweptContact last_within(const StandingPiece& piece);
  void describe(const StandingPiece&, const SweptContact& first, FoundContact& found) { found.contact = first.contact; }
  /// Nothing: an instant shows that the object is inside, but not where it entered.
  void describe_instant(const StandingPiece&, FoundContact&) {}

  /// Finds all intervals in which the surfaces of the two touch. False: nothing changes within the piece, or they do
  /// not touch in it.
  ///
  /// first  the first contact, for an object that was outside
  bool find_times(const StandingPiece& piece, bool was_in, const SweptContact* first);
  const ContactTimes& times() const { return lists_.times; }
  /// True if the object is inside after that interval, since one of the two contains some of the other.
  bool is_in_after(const StandingPiece& piece, std::size_t interval);

 private:
  TouchAtEnd surfaces_at_begin(const StandingPiece& piece);
  bool is_within_at(const StandingPiece& piece, double t);
  ContactSearch touch_surfaces(const StandingPiece& piece, const Frame& mover_frame, const Frame& fence_frame);
  bool holds_some(const Placed& outer, const Placed& inner, PiecePoints& points);
  Placed placed_fence(std::uint32_t fence, const Frame& frame);
  SweptContact sweep_span(const StandingPiece& piece, const TimeSpan& span);
  std::optional<SweptContact> sweep_sphere(const StandingPiece& piece, bool is_mover);

  const StepView& step_;
  const ObjectRows& rows_;
  FenceTable& table_;
  StandingLists& lists_;
  StepCost& cost_;
  WalkCost walk_;
  ContactSearch touch_;     // at the end of the current piece
  bool is_within_ = false;  // there one contains some of the other, and their surfaces do not touch
};

/// The whole piece if no contact was found.
inline TurnTime turn_time(const SweptContact& found) {
  return {found.yes ? found.bracket : TimeBracket{0, 1}, found.contact.point, found.contact.normal};
}

}  // namespace collided::engine
