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
  ContactTimes times;  // of the surfaces of the pair at hand, in the piece at hand
};

/// Whether an object is in a region: they touch, or one, a solid mesh, has some of the other within it. Decided by the
/// tests and sweeps that decide contacts.
///
/// One piece is decided after another: find_times() and is_in_after() read what at_end() found.
class RegionPredicate {
 public:
  using Time = SweptContact;
  /// An object that comes in and goes out again within one piece is reported as having crossed the region.
  static constexpr bool kReportsCrossings = true;
  /// After an instant that shows it in, an object no longer has the contact of where it came in.
  static constexpr bool kForgetsEntry = true;

  RegionPredicate(const StepView& step, FenceTable& table, StandingLists& lists, StepCost& cost)
      : step_(step), rows_(step.rows), table_(table), lists_(lists), cost_(cost) {}

  /// Of an object that is in a region of the world: it is so still. A filter: false says nothing.
  bool surely_holds(std::uint32_t fence, std::uint32_t mover);
  /// A filter: false says that the object is not in at any time of the piece.
  bool may_hold(const StandingPiece& piece);
  /// The object may come in or go out more than once in the piece.
  bool may_turn_back(const StandingPiece& piece);
  Decision at_end(const StandingPiece& piece, bool was_in);
  /// Of an object that came in within the piece and is not surely in at its end: it is out there.
  bool is_out_at_end(const StandingPiece&, Decision at_end) { return at_end == Decision::no; }
  SweptContact first_within(const StandingPiece& piece);
  SweptContact last_within(const StandingPiece& piece);
  void describe(const StandingPiece&, const SweptContact& first, FoundContact& found) { found.contact = first.contact; }
  /// An instant shows that the object is in, not where it came in.
  void describe_instant(const StandingPiece&, FoundContact&) {}

  /// Finds all intervals in which the surfaces of the two touch. False: nothing changes within the piece, or they do not
  /// touch in it.
  ///
  /// first  of an object that was out: the first contact
  bool find_times(const StandingPiece& piece, bool was_in, const SweptContact* first);
  const ContactTimes& times() const { return lists_.times; }
  /// The object is in after that interval, since one of the two holds some of the other.
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
  ContactSearch touch_;     // at the end of the piece at hand
  bool is_within_ = false;  // one holds some of the other there, and their surfaces do not touch
};

/// Of a contact that was not found: the whole piece.
inline TurnTime turn_time(const SweptContact& found) {
  return {found.yes ? found.bracket : TimeBracket{0, 1}, found.contact.point, found.contact.normal};
}

}  // namespace collided::engine
