// How objects enter and leave fences in one piece of motion, and when that is reported.

#include <algorithm>
#include <optional>

#include "server/world/fences/standing_decisions.hpp"

namespace collided::engine {

void StandingDecisions::decide_piece(const StandingPiece& piece) {
  if (is_resting(piece.mover_motion) && is_resting(piece.fence_motion) && piece.from_ns < piece.to_ns) return;
  table_.is_band(piece.fence) ? decide_piece_of(bands_, piece) : decide_piece_of(regions_, piece);
}

void StandingDecisions::decide_instant(const StandingPiece& instant, const Departure& left) {
  table_.is_band(instant.fence) ? decide_instant_of(bands_, instant, left) : decide_instant_of(regions_, instant, left);
}

/// An object inside leaves, stays, or is in doubt, which does not end its stay; an object outside enters within the
/// piece or does not.
template <class Predicate>
void StandingDecisions::decide_piece_of(Predicate& predicate, const StandingPiece& piece) {
  const bool was_in = is_in(piece);
  if (!was_in && !predicate.may_hold(piece)) return end_doubt(piece, whole(piece));
  if (predicate.may_turn_back(piece)) return decide_turns(predicate, piece, was_in);
  const Decision at_end = decision_at_end(predicate, piece, was_in);
  if (was_in) return decide_one_in(predicate, piece, at_end);
  ++cost_.swept;
  decide_one_out(predicate, piece, at_end, predicate.first_within(piece));
}

template <class Predicate>
Decision StandingDecisions::decision_at_end(Predicate& predicate, const StandingPiece& piece, bool was_in) {
  const Decision at_end = predicate.at_end(piece, was_in);
  if (at_end == Decision::undecided) ++cost_.undecided;
  return at_end;
}

template <class Predicate>
void StandingDecisions::decide_one_in(Predicate& predicate, const StandingPiece& piece, Decision at_end) {
  if (at_end == Decision::undecided) doubt(piece, Doubt::numeric);
  else if (at_end == Decision::no) go_out(predicate, piece);
}

/// first  when the object first enters
template <class Predicate>
void StandingDecisions::decide_one_out(Predicate& predicate, const StandingPiece& piece, Decision at_end,
                                       const typename Predicate::Time& first) {
  if (at_end == Decision::yes || first.yes) return come_in(predicate, piece, at_end, first);
  if (at_end == Decision::undecided) return doubt(piece, Doubt::numeric);
  const FoundContact found = found_in(piece);
  if (ledger_.is_in_doubt(found.a, found.b)) return end_doubt(piece, whole(piece));
  if (!first.undecided || !may_begin()) return;
  ++cost_.sweeps_skipped;
  ledger_.doubted_and_parted(found, first.is_cut_short ? Doubt::cost_limit : Doubt::numeric);
}

template <class Predicate>
void StandingDecisions::come_in(Predicate& predicate, const StandingPiece& piece, Decision at_end,
                                const typename Predicate::Time& first) {
  if (!may_begin()) return;
  const Turn came = coming_in(predicate, piece, first);
  const bool is_out = at_end != Decision::yes && predicate.is_out_at_end(piece, at_end);
  if (is_out && Predicate::kReportsCrossings)
    return report_crossing(came, bracket_of(piece, turn_time(predicate.last_within(piece))), Doubt::none);
  turn(piece, came, EndReason::none);
  if (is_out) go_out(predicate, piece);
}

template <class Predicate>
Turn StandingDecisions::coming_in(Predicate& predicate, const StandingPiece& piece,
                                  const typename Predicate::Time& first) {
  Turn came{.comes_in = true, .bracket = bracket_of(piece, turn_time(first)), .found = found_in(piece)};
  predicate.describe(piece, first, came.found);
  return came;
}

template <class Predicate>
void StandingDecisions::go_out(Predicate& predicate, const StandingPiece& piece) {
  Turn left{.comes_in = false,
            .bracket = bracket_of(piece, turn_time(predicate.last_within(piece))),
            .found = found_in(piece)};
  const Pending came = pending_of(piece);
  if (came != pending_.end() && came->second.comes_in) {
    left.bracket.low_ns = std::max(left.bracket.low_ns, came->second.bracket.low_ns);
    left.bracket.high_ns = std::max(left.bracket.high_ns, came->second.bracket.high_ns);
  }
  turn(piece, left, EndReason::separated);
}

/// For surfaces of meshes, objects of several parts, and anything that rotates: all their contacts in the piece at
/// once.
void StandingDecisions::decide_turns(RegionPredicate& region, const StandingPiece& piece, bool was_in) {
  const Decision at_end = decision_at_end(region, piece, was_in);
  SweptContact first;
  if (!was_in) {
    first = region.first_within(piece);
    ++cost_.swept;
  }
  if (at_end != Decision::undecided && region.find_times(piece, was_in, was_in ? nullptr : &first))
    return report_times(region, piece, was_in);
  was_in ? decide_one_in(region, piece, at_end) : decide_one_out(region, piece, at_end, first);
}

/// The object is inside while its surface meets that of the region, and in between if one contains some of the other.
void StandingDecisions::report_times(RegionPredicate& region, const StandingPiece& piece, bool was_in) {
  const std::vector<ContactInterval>& intervals = region.times().intervals;
  std::optional<Turn> came;
  bool is_in_now = was_in;
  // An object that could not be followed to the end of the last interval may have left and entered again.
  const Doubt last_doubt = region.times().is_last_in_doubt() ? Doubt::cost_limit : Doubt::none;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const ContactInterval& interval = intervals[i];
    if (!is_in_now && interval.begin) {
      came = coming_in(region, piece, *interval.begin);
      is_in_now = true;
    }
    if (!interval.end) break;
    if (region.is_in_after(piece, i)) continue;
    const BracketNs left = bracket_of(piece, {*interval.end, interval.last.point, interval.last.normal});
    if (came && may_begin()) report_crossing(*came, left, i + 1 == intervals.size() ? last_doubt : Doubt::none);
    else if (!came && is_in_now) turn(piece, {.comes_in = false, .bracket = left, .found = {}}, EndReason::separated);
    came.reset();
    is_in_now = false;
  }
  if (!came || !may_begin()) return;
  if (last_doubt == Doubt::none) turn(piece, *came, EndReason::none);
  else ledger_.doubts(found_at(*came), last_doubt);
}

/// For distances: finds each entry and exit by alternating searches; the last pose decides exactly.
void StandingDecisions::decide_turns(BandPredicate& band, const StandingPiece& piece, bool was_in) {
  bool is_in_now = was_in;
  double from = 0;
  for (std::uint32_t turns = 0; turns < 2 * step_.options.max_intervals; ++turns) {
    ++cost_.swept;
    GapTime next = is_in_now ? band.first_beyond(piece, from) : band.first_within(piece, from);
    if (!next.yes) {
      const Decision at_end = decision_at_end(band, piece, is_in_now);
      if (is_in_now && at_end == Decision::yes && next.is_cut_short) ++cost_.sweeps_skipped;
      next.undecided = next.undecided && from == 0;
      return is_in_now ? decide_one_in(band, piece, at_end) : decide_one_out(band, piece, at_end, next);
    }
    if (is_in_now) {
      turn(piece, {.comes_in = false, .bracket = bracket_of(piece, turn_time(next)), .found = found_in(piece)},
           EndReason::separated);
    } else {
      if (!may_begin()) return;
      turn(piece, coming_in(band, piece, next), EndReason::none);
    }
    is_in_now = !is_in_now;
    from = next.bracket.high;
  }
  ++cost_.undecided;
  doubt(piece, Doubt::cost_limit);
}

template <class Predicate>
void StandingDecisions::decide_instant_of(Predicate& predicate, const StandingPiece& instant, const Departure& left) {
  const bool was_in = is_in(instant);
  const Decision now = decision_at_end(predicate, instant, was_in);
  if (now == Decision::undecided) return doubt(instant, Doubt::numeric);
  if (now == Decision::no && !was_in) return end_doubt(instant, left.bracket);
  if (now == Decision::yes) {
    if (was_in && Predicate::kForgetsEntry) ledger_.touches(found_in(instant));
    if (was_in || !may_begin()) return;
    Turn came{.comes_in = true, .bracket = whole(instant), .found = found_in(instant)};
    predicate.describe_instant(instant, came.found);
    return turn(instant, came, EndReason::none);
  }
  const Turn gone{.comes_in = false, .bracket = left.bracket, .found = found_in(instant)};
  if (left.reason != EndReason::teleported) return turn(instant, gone, left.reason);
  // A teleported object leaves at once, without dwell.
  if (const Pending came = pending_of(instant); came != pending_.end()) pending_.erase(came);
  if (ledger_.holds(gone.found.a, gone.found.b)) report(gone.found.a, gone.found.b, gone, left.reason);
}

/// An object that was inside is outside, or the reverse: reported if the dwell is over, dropped if it turned back
/// before.
void StandingDecisions::turn(const StandingPiece& piece, const Turn& turned, EndReason reason) {
  const std::pair<ObjectId, ObjectId> pair{rows_.info(piece.mover)->id, table_.id(piece.fence)};
  if (const Pending before = pending_of(piece); before != pending_.end()) {
    const bool lasted = outlasts(piece, before, turned);
    pending_.erase(before);
    if (!lasted) return;
  }
  // Any finding about a lost object is in doubt at once.
  const bool waits =
      table_.rule(piece.fence).dwell_ns(turned.comes_in) > 0 && !ledger_.has_lost(pair.first, pair.second);
  if (waits) pending_.insert_or_assign(pair, turned);
  else report(pair.first, pair.second, turned, reason);
}

/// True if the pending turn lasted for its dwell before the next one; then it is reported. If their brackets leave that
/// open, it is reported as a doubt.
bool StandingDecisions::outlasts(const StandingPiece& piece, Pending here, const Turn& next) {
  const Turn& pending = here->second;
  const auto& [a, b] = here->first;
  const std::int64_t dwell_ns = table_.rule(piece.fence).dwell_ns(pending.comes_in);
  if (next.bracket.low_ns - pending.bracket.high_ns >= dwell_ns) {
    report(a, b, pending, EndReason::separated);
    return true;
  }
  if (next.bracket.high_ns - pending.bracket.low_ns < dwell_ns) return false;
  FoundContact found = found_at(pending);
  found.parted_low_s = step_.seconds_ago(next.bracket.low_ns);
  found.parted_high_s = step_.seconds_ago(next.bracket.high_ns);
  if (pending.comes_in) {
    ledger_.doubted_and_parted(found, Doubt::numeric);
  } else {
    ledger_.parts(a, b, EndReason::separated, found.bracket_low_s, found.bracket_high_s);
    ledger_.doubts(found, Doubt::numeric);
    report(a, b, next, EndReason::none);
  }
  return false;
}

void StandingDecisions::report(ObjectId a, ObjectId b, const Turn& turned, EndReason reason) {
  const FoundContact found = found_at(turned);
  turned.comes_in ? ledger_.touches(found) : ledger_.parts(a, b, reason, found.bracket_low_s, found.bracket_high_s);
}

FoundContact StandingDecisions::found_at(const Turn& turned) const {
  FoundContact found = turned.found;
  found.bracket_low_s = found.parted_low_s = step_.seconds_ago(turned.bracket.low_ns);
  found.bracket_high_s = found.parted_high_s = step_.seconds_ago(turned.bracket.high_ns);
  return found;
}

/// doubt  why it is unknown whether the object entered again; none: it did not
void StandingDecisions::report_crossing(const Turn& came, const BracketNs& left, Doubt doubt) {
  FoundContact found = found_at(came);
  // It left no earlier than it entered.
  found.parted_low_s = std::min(step_.seconds_ago(left.low_ns), found.bracket_low_s);
  found.parted_high_s = std::min(step_.seconds_ago(left.high_ns), found.parted_low_s);
  if (doubt != Doubt::none) return ledger_.doubted_and_parted(found, doubt);
  const FenceRule& rule = table_.rule(slot_of(found.b));
  ledger_.touched_and_parted(found, !rule.band && (rule.detects & codes::kDetectCross) != 0);
}

void StandingDecisions::doubt(const StandingPiece& piece, Doubt why) {
  if (const Pending before = pending_of(piece); before != pending_.end()) pending_.erase(before);
  const FoundContact found = found_in(piece);
  if (ledger_.is_open(found.a, found.b) || may_begin()) ledger_.doubts(found, why);
}

void StandingDecisions::end_doubt(const StandingPiece& piece, const BracketNs& apart) {
  ledger_.decided_apart(rows_.info(piece.mover)->id, table_.id(piece.fence), step_.seconds_ago(apart.low_ns),
                        step_.seconds_ago(apart.high_ns));
}

void StandingDecisions::note_considered(std::uint32_t fence, std::uint32_t mover, std::uint64_t step) {
  if (pending_.empty()) return;
  const Pending here = pending_.find({rows_.info(mover)->id, table_.id(fence)});
  if (here != pending_.end()) here->second.considered_in_step = step;
}

void StandingDecisions::settle() {
  for (auto next = pending_.begin(); next != pending_.end();) {
    const auto here = next++;
    const auto& [pair, turned] = *here;
    const std::uint32_t fence = slot_of(pair.second);
    const std::int64_t dwell_ns = table_.rule(fence).dwell_ns(turned.comes_in);
    if (known_ns(pair.first, fence) - turned.bracket.high_ns < dwell_ns) continue;
    report(pair.first, pair.second, turned, EndReason::separated);
    pending_.erase(here);
  }
}

std::int64_t StandingDecisions::known_ns(ObjectId mover, std::uint32_t fence) const {
  std::int64_t known_ns = kForEver;
  for (const std::uint32_t slot : {slot_of(mover), table_.carrier(fence)}) {
    if (slot == FenceTable::kNone || rows_.source(slot) == Sources::kResting) continue;
    known_ns = std::min(known_ns, step_.sources[rows_.source(slot)].known_of(rows_[slot].posed_ns));
  }
  return known_ns;
}

StandingDecisions::Pending StandingDecisions::pending_of(const StandingPiece& piece) {
  if (pending_.empty()) return pending_.end();
  return pending_.find({rows_.info(piece.mover)->id, table_.id(piece.fence)});
}

/// True if the object is inside at present, reported or not.
bool StandingDecisions::is_in(const StandingPiece& piece) {
  const bool is_reported = ledger_.holds(rows_.info(piece.mover)->id, table_.id(piece.fence));
  return is_reported != (pending_of(piece) != pending_.end());
}

/// True if there is room for one more entry; else the search is marked as cut short.
bool StandingDecisions::may_begin() {
  cost_.truncated = cost_.truncated || ledger_.open().size() >= step_.options.max_contacts;
  return !cost_.truncated;
}

/// Bracketed by the whole piece; callers with a narrower bracket set it.
FoundContact StandingDecisions::found_in(const StandingPiece& piece) const {
  FoundContact found{.a = rows_.info(piece.mover)->id, .b = table_.id(piece.fence), .contact = {}};
  const BracketNs bracket = whole(piece);
  found.bracket_low_s = found.parted_low_s = step_.seconds_ago(bracket.low_ns);
  found.bracket_high_s = found.parted_high_s = step_.seconds_ago(bracket.high_ns);
  return found;
}

BracketNs StandingDecisions::whole(const StandingPiece& piece) const {
  const std::int64_t error_ns = clock_error_ns(piece);
  return {piece.from_ns - error_ns, piece.to_ns + error_ns};
}

BracketNs StandingDecisions::bracket_of(const StandingPiece& piece, const TurnTime& time) const {
  const std::int64_t error_ns = clock_error_ns(piece);
  const BracketNs found = in_nanoseconds(piece.from_ns, piece.to_ns, {piece.mover_motion, piece.fence_motion},
                                         time.bracket, time.point, time.normal);
  return {found.low_ns - error_ns, found.high_ns + error_ns};
}

/// A fence in the world has the mover's clock; a carried one has its carrier's. A band around an object that never
/// moves has the mover's.
std::int64_t StandingDecisions::clock_error_ns(const StandingPiece& piece) const {
  const std::uint32_t carrier = table_.carrier(piece.fence);
  if (carrier == FenceTable::kNone || rows_.source(carrier) == rows_.source(piece.mover)) return 0;
  const bool is_fixed_band = table_.is_band(piece.fence) && rows_.source(carrier) == Sources::kResting;
  return is_fixed_band ? 0 : step_.options.clock_error_ns;
}

}  // namespace collided::engine
