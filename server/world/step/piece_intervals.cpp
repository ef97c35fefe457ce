// Pairs that may touch several times in a piece: meshes, objects of several parts, and anything that rotates. All their
// contacts in the piece are found and reported, in order.

#include <algorithm>

#include "server/geometry/tolerance.hpp"
#include "server/world/step/decisions.hpp"

namespace collided::engine {

/// The two ends of a piece show everything that two single convex objects do if they move straight.
bool Decisions::is_cut(const PairPiece& piece) const {
  return piece.scene != nullptr ||
         !touch_at_most_once(*rows_.info(piece.a), piece.a_motion, *rows_.info(piece.b), piece.b_motion);
}

/// False: the surfaces of the two do not touch in the piece, or it is unknown whether they do at its end.
///
/// first  the first contact of their surfaces, for two that were not in contact
bool Decisions::decide_intervals(const PairPiece& piece, const ContactSearch& touch, const WithinSolid& within,
                                 const SweptContact* first) {
  if (!is_cut(piece) || (touch.undecided && !touch.yes)) return false;
  const ObjectId a = rows_.info(piece.a)->id;
  const ObjectId b = rows_.info(piece.b)->id;
  const TouchAtEnd begin = ledger_.holds(a, b) ? surfaces_at_begin(piece) : TouchAtEnd{};
  const TouchAtEnd end{touch.yes && !within.is_some, touch.a_triangle, touch.b_triangle, touch.contact};
  if (!begin.yes && !end.yes && first != nullptr && !first->yes) return false;
  if (!find_intervals(piece, begin, end, first)) return false;
  if (lists_.times.intervals.empty()) return false;
  if (lists_.times.is_open) ++cost_.sweeps_skipped;
  lists_.gaps.assign(lists_.times.intervals.size(), {});
  lists_.gaps.back() = within;
  if (rows_.info(piece.a)->rare->solid || rows_.info(piece.b)->rare->solid) {
    for (std::size_t i = 0; i + 1 < lists_.gaps.size(); ++i) {
      const double t = (lists_.times.intervals[i].end->high + lists_.times.intervals[i + 1].begin->bracket.low) / 2;
      touch_at(piece, piece.a_motion.at(t), piece.b_motion.at(t), &lists_.gaps[i]);
    }
  }
  report_intervals(piece, touch);
  return true;
}

/// For two in contact: whether their surfaces touch when the piece begins. Without a solid they must.
TouchAtEnd Decisions::surfaces_at_begin(const PairPiece& piece) {
  const ObjectId a = rows_.info(piece.a)->id;
  const ObjectId b = rows_.info(piece.b)->id;
  const OpenContact& open = *ledger_.find(a, b);
  if (!rows_.info(piece.a)->rare->solid && !rows_.info(piece.b)->rare->solid)
    return {true, open.a_triangle, open.b_triangle, open.contact};
  if (open.contained != Contained::none) return {};
  const ContactSearch touch = touch_at(piece, piece.a_motion.from, piece.b_motion.from, nullptr);
  return {touch.yes, touch.a_triangle, touch.b_triangle, touch.contact};
}

/// Fills lists_.times. False: they touch throughout.
bool Decisions::find_intervals(const PairPiece& piece, const TouchAtEnd& begin, const TouchAtEnd& end,
                               const SweptContact* first) {
  const auto body_of = [&](std::uint32_t slot, const BodyMotion& motion) {
    const bool is_part = rows_.info(slot)->scene_part != kNoScenePart;
    return is_part ? SweptBody(*piece.scene) : SweptBody(*rows_.info(slot), motion);
  };
  const auto first_triangle_of = [&](std::uint32_t slot) {
    const std::uint32_t part = rows_.info(slot)->scene_part;
    return part == kNoScenePart ? 0 : piece.scene->parts[part].first_triangle;
  };
  const SweptBody a = body_of(piece.a, piece.a_motion);
  const SweptBody b = body_of(piece.b, piece.b_motion);
  const double width = bracket_width(piece);
  std::optional<PairPiece> back;
  const auto sweep_from = [&](const TimeSpan& span, bool is_reversed) {
    if (is_reversed && !back) back = piece.reversed();
    const PairPiece& way = is_reversed ? *back : piece;
    if (span.low == 0 && span.high == 1) return sweep_piece(way);
    if (piece.scene != nullptr) return sweep_part_piece(way, span, width);
    return sweep_span(body_of(way.a, way.a_motion), body_of(way.b, way.b_motion), span, width);
  };
  const auto test_at = [&](double t) { return touch_at(piece, piece.a_motion.at(t), piece.b_motion.at(t), nullptr); };
  const BodiesInMotion bodies({a, rows_[piece.a].reach_m, first_triangle_of(piece.a)},
                              {b, rows_[piece.b].reach_m, first_triangle_of(piece.b)}, sweep_from, test_at);
  if (begin.yes && end.yes && surely_touch_throughout(bodies, begin, end)) return false;
  find_contact_times(bodies, begin, end, first, {.width = width, .most = step_.options.max_intervals}, lists_.times);
  return true;
}

/// Reports lists_.times and lists_.gaps.
void Decisions::report_intervals(const PairPiece& piece, const ContactSearch& touch) {
  const std::vector<ContactInterval>& intervals = lists_.times.intervals;
  const ObjectId a = rows_.info(piece.a)->id;
  const ObjectId b = rows_.info(piece.b)->id;
  const bool was_held = ledger_.holds(a, b);
  bool is_new = false;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    if (intervals[i].begin) {
      if (!ledger_.holds(a, b)) {
        if (!begin_interval(piece, i, touch)) return;
        is_new = true;
      } else {
        const PieceBracket met = in_seconds(piece, intervals[i].begin->bracket, intervals[i].begin->contact);
        ledger_.changes_containment(a, b, Contained::none, {EndReason::separated, met.low_s, met.high_s});
      }
    }
    if (intervals[i].end && ledger_.holds(a, b)) end_interval(piece, i);
  }
  if (lists_.times.is_last_in_doubt() && !intervals.back().begin) doubt_after(piece);
  const OpenContact* open = ledger_.find(a, b);
  if (open == nullptr || !was_held || is_new || !touch.yes) return;
  FoundContact found = found_at(piece, touch.a_triangle, touch.b_triangle, touch.contact, 1);
  found.contained = open->contained;
  ledger_.touches(found);
  ++cost_.contacts;
}

/// Opens the contact that begins with that interval. False: there is no room for it.
bool Decisions::begin_interval(const PairPiece& piece, std::size_t number, const ContactSearch& touch) {
  if (!may_begin()) return false;
  ++cost_.contacts;
  const std::vector<ContactInterval>& intervals = lists_.times.intervals;
  bool lasts = touch.yes;
  for (std::size_t i = number; i < intervals.size(); ++i)
    lasts = lasts && (!intervals[i].end || lists_.gaps[i].is_some);
  const SweptContact& first = *intervals[number].begin;
  const bool is_last_of_all = number + 1 == intervals.size();
  const PieceBracket met = in_seconds(piece, first.bracket, first.contact);
  std::optional<double> slack_s;
  if (piece.is_of_step) slack_s = met.low_s - met.high_s;
  FoundContact found =
      lasts ? found_at(piece, touch.a_triangle, touch.b_triangle, touch.contact, 1, slack_s)
            : found_at(piece, first.a_triangle, first.b_triangle, first.contact, first.bracket.high, slack_s);
  found.bracket_low_s = met.low_s;
  found.bracket_high_s = met.high_s;
  if (!(lists_.times.is_last_in_doubt() && is_last_of_all)) {
    if (intervals[number].end) {
      const PieceBracket parted = parted_in(piece, intervals[number]);
      found.contained = lists_.gaps[number].contained;
      found.parted_low_s = parted.low_s;
      found.parted_high_s = parted.high_s;
    }
    ledger_.touches(found);
    return true;
  }
  // They may have separated and met again.
  ledger_.doubts(found, Doubt::cost_limit);
  if (!touch.yes) {
    const PieceBracket parted = parted_in(piece, intervals[number]);
    ledger_.decided_apart(found.a, found.b, parted.low_s, parted.high_s);
  }
  return true;
}

/// A contact from before has ended in the piece, and within its bracket the two may have met again.
void Decisions::doubt_after(const PairPiece& piece) {
  const PieceBracket last = in_seconds(piece, *lists_.times.intervals.back().end, {});
  ledger_.doubted_and_parted({.a = rows_.info(piece.a)->id,
                              .b = rows_.info(piece.b)->id,
                              .contact = {},
                              .bracket_low_s = last.low_s,
                              .bracket_high_s = last.high_s,
                              .parted_low_s = last.low_s,
                              .parted_high_s = last.high_s},
                             Doubt::cost_limit);
}

/// When the surfaces separate at the end of an interval: no earlier than they met.
Decisions::PieceBracket Decisions::parted_in(const PairPiece& piece, const ContactInterval& interval) const {
  PieceBracket parted = in_seconds(piece, *interval.end, interval.last);
  if (!interval.begin) return parted;
  const PieceBracket met = in_seconds(piece, interval.begin->bracket, interval.begin->contact);
  parted.low_s = std::min(parted.low_s, met.low_s);
  parted.high_s = std::min(parted.high_s, parted.low_s);
  return parted;
}

/// The surfaces of the two separate: their contact ends, or continues within a solid.
void Decisions::end_interval(const PairPiece& piece, std::size_t number) {
  const ContactInterval& interval = lists_.times.intervals[number];
  const ObjectId a = rows_.info(piece.a)->id;
  const ObjectId b = rows_.info(piece.b)->id;
  const PieceBracket parted = parted_in(piece, interval);
  const WithinSolid& then = lists_.gaps[number];
  if (then.is_some) {
    if (then.contained != Contained::none)
      ledger_.changes_containment(a, b, then.contained, {EndReason::none, parted.low_s, parted.high_s});
  } else {
    ledger_.parts(a, b, EndReason::separated, parted.low_s, parted.high_s);
  }
}

}  // namespace collided::engine
