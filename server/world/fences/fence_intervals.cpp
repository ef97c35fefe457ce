// Objects that may be in a fence several times in a piece: meshes, objects and fences of several parts, and whatever
// turns. As world/step/piece_intervals.cpp.

#include <algorithm>

#include "server/world/fences/fence_decisions.hpp"

namespace collided::engine {

/// What a single convex object that goes straight does in a piece shows from both its ends.
bool FenceDecisions::is_cut(const FencePiece& piece) const {
  return !touch_at_most_once(*rows_.info(piece.mover), piece.mover_motion, table_.body(piece.fence),
                             piece.fence_motion);
}

/// False: nothing changes within the piece, the surfaces of the two do not touch in it, or it is not known whether the
/// object is in at its end.
bool FenceDecisions::decide_intervals(const FencePiece& piece, const ContactSearch& touch, bool is_within,
                                      const SweptContact* first) {
  if (!is_cut(piece) || (touch.undecided && !touch.yes)) return false;
  const bool is_held = ledger_.holds(rows_.info(piece.mover)->id, table_.id(piece.fence));
  const TouchAtEnd begin = surfaces_at_begin(piece, is_held);
  const TouchAtEnd end{touch.yes && !is_within, touch.a_triangle, touch.b_triangle, touch.contact};
  if (!begin.yes && !end.yes && first != nullptr && !first->yes) return false;
  if (!find_intervals(piece, begin, end, first)) return false;
  if (lists_.times.is_open) ++cost_.sweeps_skipped;
  report_intervals(piece, touch.yes);
  return true;
}

/// Of an object that is in: whether the surfaces touch when the piece begins. Without a solid mesh nothing else is in.
TouchAtEnd FenceDecisions::surfaces_at_begin(const FencePiece& piece, bool is_held) {
  if (!is_held) return {};
  if (!rows_.info(piece.mover)->rare->solid && !table_.body(piece.fence).rare->solid) return {.yes = true};
  const ContactSearch touch = touch_surfaces(piece, piece.mover_motion.from, piece.fence_motion.from);
  return {touch.yes, touch.a_triangle, touch.b_triangle, touch.contact};
}

/// Fills lists_.times. False: the surfaces do not touch, or they do throughout.
bool FenceDecisions::find_intervals(const FencePiece& piece, const TouchAtEnd& begin, const TouchAtEnd& end,
                                    const SweptContact* first) {
  const FencePiece back = piece.reversed();
  const SweptBody mover(*rows_.info(piece.mover), piece.mover_motion);
  const SweptBody fence(table_.body(piece.fence), piece.fence_motion);
  const auto sweep_from = [&](const TimeSpan& span, bool is_reversed) {
    const FencePiece& way = is_reversed ? back : piece;
    return span.low == 0 && span.high == 1 ? sweep(way) : sweep_span(way, span);
  };
  const auto test_at = [&](double t) {
    return touch_surfaces(piece, piece.mover_motion.at(t), piece.fence_motion.at(t));
  };
  const BodiesInMotion bodies{.a = mover,
                              .b = fence,
                              .first = sweep_from,
                              .touch_at = test_at,
                              .off_m = 2 * (piece.mover_motion.error_m(rows_[piece.mover].reach_m) +
                                            piece.fence_motion.error_m(table_.reach_m(piece.fence)))};
  if (begin.yes && end.yes && surely_touch_throughout(bodies, begin, end)) return false;
  const ContactTimesLimits limits{.width = bracket_width(piece), .most = step_.options.max_intervals};
  find_contact_times(bodies, begin, end, first, limits, lists_.times);
  return !lists_.times.intervals.empty();
}

/// Reports when the object is in, as its surface meets that of the fence and between, where one holds some of the other.
void FenceDecisions::report_intervals(const FencePiece& piece, bool is_in_at_end) {
  const std::vector<ContactInterval>& intervals = lists_.times.intervals;
  FoundContact found = found_in(piece);
  bool is_in = ledger_.holds(found.a, found.b);
  bool has_come = false;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const ContactInterval& interval = intervals[i];
    if (!is_in && interval.begin) {
      const ContactEnd came = in_seconds(piece, interval.begin->bracket, interval.begin->contact);
      found.contact = interval.begin->contact;
      found.bracket_low_s = came.bracket_low_s;
      found.bracket_high_s = came.bracket_high_s;
      is_in = has_come = true;
    }
    if (!interval.end) break;
    const bool is_last = i + 1 == intervals.size();
    const bool goes_on =
        is_last ? is_in_at_end : is_within_at(piece, (interval.end->high + intervals[i + 1].begin->bracket.low) / 2);
    if (goes_on) continue;
    const ContactEnd left = in_seconds(piece, *interval.end, interval.last);
    if (!has_come) {
      if (ledger_.holds(found.a, found.b))
        ledger_.parts(found.a, found.b, left.reason, left.bracket_low_s, left.bracket_high_s);
    } else if (may_begin()) {
      found.parted_low_s = std::min(left.bracket_low_s, found.bracket_low_s);
      found.parted_high_s = std::min(left.bracket_high_s, found.parted_low_s);
      // What was not cut any more may have gone out and come in again.
      if (is_last && lists_.times.is_last_in_doubt()) ledger_.doubted_and_parted(found, Doubt::cost_limit);
      else ledger_.touched_and_parted(found);
    }
    is_in = has_come = false;
  }
  if (!is_in || !has_come || !may_begin()) return;
  if (lists_.times.is_last_in_doubt()) ledger_.doubts(found, Doubt::cost_limit);
  else ledger_.touches(found);
}

}  // namespace collided::engine
