#include "server/world/fences/band_decisions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/geometry/guess_tolerance.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/contact_times.hpp"

namespace collided::engine {
namespace {

/// Width of brackets: reported times are whole nanoseconds.
constexpr double kBandSweepWidth_s = 1e-9;
/// Looks at the two of a pair that one search may take, and those of a step together before each has only the least.
constexpr std::uint32_t kMostBandLooks = 2'000;
constexpr std::uint32_t kBandLooksOfStep = 200'000;
constexpr std::uint32_t kLeastBandLooks = 200;
/// How far ahead a contact is predicted, and how wide its bracket is then, as a fraction of that.
constexpr double kPredicted_s = 60;
constexpr double kPredictedWidth = 1e-9;
constexpr double kPredictedTurn_rad = 1.5;

GapBody body_of(const ObjectRows& rows, std::uint32_t slot, const BodyMotion& motion) {
  return {.info = rows.info(slot),
          .motion = motion,
          .reach_m = motion.turn_rad > 0 ? motion.lever_m(rows[slot].reach_m) : 0};
}

double seconds_of(const FencePiece& piece) {
  return static_cast<double>(piece.to_ns - piece.from_ns) * wire_contract::kNanosecond_s;
}

/// The body's motion from time t of a piece of that length on, for so many seconds more.
BodyMotion goes_on(const BodyMotion& motion, double t, double piece_s, double seconds) {
  const Frame now = motion.at(t);
  Frame then{.rotation = now.rotation, .position = now.position + motion.travel * (seconds / piece_s)};
  if (motion.turn_rad > 0) {
    const double angle = motion.turn_rad * (seconds / piece_s);
    then.rotation = Eigen::AngleAxisd(angle, motion.axis).toRotationMatrix() * now.rotation;
    then.position += now.rotation * motion.pivot - then.rotation * motion.pivot;
  }
  return {now, then, motion.pivot};
}

}  // namespace

BandDecisions::Pending BandDecisions::pending_of(const FencePiece& piece) {
  return pending_.find({rows_.info(piece.mover)->id, table_.id(piece.fence)});
}

/// Whether the object is in as of now, told or not.
bool BandDecisions::is_in(const FencePiece& piece) {
  const bool is_told = ledger_.holds(rows_.info(piece.mover)->id, table_.id(piece.fence));
  return is_told != (pending_of(piece) != pending_.end());
}

void BandDecisions::decide_piece(const FencePiece& piece) {
  if (is_resting(piece.mover_motion) && is_resting(piece.fence_motion) && piece.from_ns < piece.to_ns) return;
  if (may_turn_back(piece)) return decide_turns(piece);
  is_in(piece) ? decide_one_that_is_in(piece) : decide_one_that_is_out(piece);
}

void BandDecisions::decide_one_that_is_in(const FencePiece& piece) {
  switch (within_at_end(piece, rule(piece).stays_in())) {
    case Decision::yes: return;
    case Decision::undecided: return doubt(piece, Doubt::numeric);
    case Decision::no: return go_out(piece);
  }
}

void BandDecisions::decide_one_that_is_out(const FencePiece& piece) {
  const FoundContact found = found_in(piece);
  const auto is_apart = [&] { ledger_.decided_apart(found.a, found.b, found.bracket_low_s, found.bracket_high_s); };
  if (!may_be_near(piece)) return is_apart();
  const Decision at_end = within_at_end(piece, rule(piece).comes_in());
  const GapTime first = first_within(piece, rule(piece).comes_in());
  ++cost_.swept;
  if (at_end == Decision::yes || first.yes) return come_in(piece, first, at_end);
  if (at_end == Decision::undecided) return doubt(piece, Doubt::numeric);
  if (ledger_.is_in_doubt(found.a, found.b)) return is_apart();
  if (!first.undecided || !may_begin()) return;
  ++cost_.sweeps_skipped;
  ledger_.doubted_and_parted(found, first.is_cut_short ? Doubt::cost_limit : Doubt::numeric);
}

/// The distance of two single convex objects that go straight has one minimum: they come in and go out once. Within a
/// distance of 0 nothing is so by more than a rounding, and no search finds where that ends.
bool BandDecisions::may_turn_back(const FencePiece& piece) const {
  return rule(piece).stays_in().low_m() > 0 &&
         !touch_at_most_once(*rows_.info(piece.mover), piece.mover_motion, *rows_.info(table_.carrier(piece.fence)),
                             piece.fence_motion);
}

/// Each coming in and going out in the piece, by alternating searches.
void BandDecisions::decide_turns(const FencePiece& piece) {
  bool is_in_now = is_in(piece);
  if (!is_in_now && !may_be_near(piece)) {
    const FoundContact found = found_in(piece);
    return ledger_.decided_apart(found.a, found.b, found.bracket_low_s, found.bracket_high_s);
  }
  double from = 0;
  for (std::uint32_t turns = 0; turns < 2 * step_.options.max_intervals; ++turns) {
    ++cost_.swept;
    const GapTime next = is_in_now ? first_beyond(piece, rule(piece).stays_in(), from)
                                   : first_within(piece, rule(piece).comes_in(), from);
    if (!next.yes) return decide_end(piece, is_in_now, from, next);
    if (!is_in_now && !may_begin()) return;
    const BracketNs bracket = in_nanoseconds(piece, next, false);
    turn(piece,
         {.comes_in = !is_in_now, .bracket = bracket, .found = is_in_now ? found_in(piece) : found_at(piece, next)},
         is_in_now ? EndReason::separated : EndReason::none);
    is_in_now = !is_in_now;
    from = next.bracket.high;
  }
  doubt(piece, Doubt::cost_limit);
}

/// No further turn was found from that time on: the last pose decides exactly.
void BandDecisions::decide_end(const FencePiece& piece, bool is_in_now, double from, const GapTime& last) {
  const Decision at_end = within_at_end(piece, is_in_now ? rule(piece).stays_in() : rule(piece).comes_in());
  if (at_end == Decision::undecided) return doubt(piece, Doubt::numeric);
  const FoundContact found = found_in(piece);
  if (is_in_now) {
    if (at_end == Decision::no) go_out(piece);
    else if (last.is_cut_short) ++cost_.sweeps_skipped;
  } else if (at_end == Decision::yes) {
    come_in(piece, last, at_end);
  } else if (ledger_.is_in_doubt(found.a, found.b)) {
    ledger_.decided_apart(found.a, found.b, found.bracket_low_s, found.bracket_high_s);
  } else if (from == 0 && last.undecided && may_begin()) {
    ++cost_.sweeps_skipped;
    ledger_.doubted_and_parted(found, last.is_cut_short ? Doubt::cost_limit : Doubt::numeric);
  }
}

void BandDecisions::come_in(const FencePiece& piece, const GapTime& first, Decision at_end) {
  if (!may_begin()) return;
  turn(piece, {.comes_in = true, .bracket = in_nanoseconds(piece, first, false), .found = found_at(piece, first)},
       EndReason::none);
  if (at_end == Decision::yes) return;
  if (within_at_end(piece, rule(piece).stays_in()) == Decision::no) go_out(piece);
}

/// When an object that is out at the end was in for the last time: the first such time of the reversed motion.
void BandDecisions::go_out(const FencePiece& piece) {
  const GapTime last = first_within(piece.reversed(), rule(piece).stays_in());
  PendingTurn turned{.comes_in = false, .bracket = in_nanoseconds(piece, last, true), .found = found_in(piece)};
  const Pending came = pending_of(piece);
  if (came != pending_.end() && came->second.comes_in) {
    turned.bracket.low_ns = std::max(turned.bracket.low_ns, came->second.bracket.low_ns);
    turned.bracket.high_ns = std::max(turned.bracket.high_ns, came->second.bracket.high_ns);
  }
  turn(piece, turned, EndReason::separated);
}

void BandDecisions::decide_instant(const FencePiece& instant, const ContactEnd& left) {
  const bool was_in = is_in(instant);
  const Decision now = within_at_end(instant, was_in ? rule(instant).stays_in() : rule(instant).comes_in());
  const FoundContact found = found_in(instant);
  if (now == Decision::undecided) return doubt(instant, Doubt::numeric);
  if (was_in == (now == Decision::yes)) {
    if (!was_in) ledger_.decided_apart(found.a, found.b, left.bracket_low_s, left.bracket_high_s);
    return;
  }
  if (!was_in) {
    if (!may_begin()) return;
    const std::int64_t error_ns = clock_error_ns(instant);
    GapTime at{.yes = true, .undecided = false, .is_cut_short = false, .bracket = {1, 1}, .at = {}};
    at.at = first_within(instant, rule(instant).comes_in()).at;
    return turn(instant,
                {.comes_in = true,
                 .bracket = {instant.from_ns - error_ns, instant.to_ns + error_ns},
                 .found = found_at(instant, at)},
                EndReason::none);
  }
  const auto time_ns = [&](double ago_s) { return step_.world_time_ns - std::llround(ago_s * 1e9); };
  const PendingTurn turned{
      .comes_in = false, .bracket = {time_ns(left.bracket_low_s), time_ns(left.bracket_high_s)}, .found = found};
  if (left.reason != EndReason::teleported) return turn(instant, turned, left.reason);
  // Who is put elsewhere is gone, however short a time ago.
  const Pending came = pending_of(instant);
  if (came != pending_.end()) pending_.erase(came);
  if (ledger_.holds(found.a, found.b)) tell(found.a, found.b, turned, left.reason);
}

/// An object that was in is out, or the other way round: told if the dwell is over, forgotten if it turned back before.
void BandDecisions::turn(const FencePiece& piece, const PendingTurn& turned, EndReason reason) {
  const std::pair<ObjectId, ObjectId> pair{rows_.info(piece.mover)->id, table_.id(piece.fence)};
  if (const Pending before = pending_.find(pair); before != pending_.end()) {
    const bool lasted = outlasts(piece, turned);
    pending_.erase(before);
    if (!lasted) return;
  }
  const std::int64_t dwell_ns = turned.comes_in ? rule(piece).dwell_in_ns : rule(piece).dwell_out_ns;
  if (dwell_ns == 0) return tell(pair.first, pair.second, turned, reason);
  pending_.insert_or_assign(pair, turned);
}

/// Whether what is pending lasted for its dwell before the next turn; then it is told. Where the brackets of the two
/// turns leave that open, it is told as a doubt.
bool BandDecisions::outlasts(const FencePiece& piece, const PendingTurn& next) {
  const Pending here = pending_of(piece);
  const PendingTurn pending = here->second;
  const auto& [a, b] = here->first;
  const std::int64_t dwell_ns = pending.comes_in ? rule(piece).dwell_in_ns : rule(piece).dwell_out_ns;
  if (next.bracket.low_ns - pending.bracket.high_ns >= dwell_ns) {
    tell(a, b, pending, EndReason::separated);
    return true;
  }
  if (next.bracket.high_ns - pending.bracket.low_ns < dwell_ns) return false;
  FoundContact found = pending.found;
  found.bracket_low_s = step_.seconds_ago(pending.bracket.low_ns);
  found.bracket_high_s = step_.seconds_ago(pending.bracket.high_ns);
  found.parted_low_s = step_.seconds_ago(next.bracket.low_ns);
  found.parted_high_s = step_.seconds_ago(next.bracket.high_ns);
  if (pending.comes_in) {
    ledger_.doubted_and_parted(found, Doubt::numeric);
  } else {
    ledger_.parts(a, b, EndReason::separated, found.bracket_low_s, found.bracket_high_s);
    ledger_.doubts(found, Doubt::numeric);
    tell(a, b, next, EndReason::none);
  }
  return false;
}

void BandDecisions::doubt(const FencePiece& piece, Doubt why) {
  ++cost_.undecided;
  if (const Pending before = pending_of(piece); before != pending_.end()) pending_.erase(before);
  if (may_begin()) ledger_.doubts(found_in(piece), why);
}

void BandDecisions::tell(ObjectId a, ObjectId b, const PendingTurn& turned, EndReason reason) {
  const double low_s = step_.seconds_ago(turned.bracket.low_ns);
  const double high_s = step_.seconds_ago(turned.bracket.high_ns);
  if (!turned.comes_in) return ledger_.parts(a, b, reason, low_s, high_s);
  FoundContact found = turned.found;
  found.bracket_low_s = found.parted_low_s = low_s;
  found.bracket_high_s = found.parted_high_s = high_s;
  ledger_.touches(found);
}

void BandDecisions::note_considered(std::uint32_t fence, std::uint32_t mover, std::uint64_t step) {
  if (pending_.empty()) return;
  const Pending here = pending_.find({rows_.info(mover)->id, table_.id(fence)});
  if (here != pending_.end()) here->second.considered_in_step = step;
}

void BandDecisions::settle() {
  for (auto next = pending_.begin(); next != pending_.end();) {
    const auto here = next++;
    const auto& [pair, turned] = *here;
    const std::uint32_t fence = slot_of(pair.second);
    const BandRule& band = *table_.rule(fence).band;
    const std::int64_t dwell_ns = turned.comes_in ? band.dwell_in_ns : band.dwell_out_ns;
    if (known_ns(pair.first, fence) - turned.bracket.high_ns < dwell_ns) continue;
    tell(pair.first, pair.second, turned, EndReason::separated);
    pending_.erase(here);
  }
}

std::int64_t BandDecisions::known_ns(ObjectId mover, std::uint32_t fence) const {
  std::int64_t known_ns = kForEver;
  for (const std::uint32_t slot : {slot_of(mover), table_.carrier(fence)}) {
    if (rows_.source(slot) == Sources::kResting) continue;
    known_ns = std::min(known_ns, step_.sources[rows_.source(slot)].known_of(rows_[slot].posed_ns));
  }
  return known_ns;
}

/// Whether the bounds of the two on their way are near enough.
bool BandDecisions::may_be_near(const FencePiece& piece) const {
  const std::uint32_t carrier = table_.carrier(piece.fence);
  const Aabb mover = bounds(*rows_.info(piece.mover), piece.mover_motion, rows_[piece.mover].reach_m);
  const Aabb about = bounds(*rows_.info(carrier), piece.fence_motion, rows_[carrier].reach_m);
  return overlaps(mover, grown(about, table_.beyond_m(piece.fence)));
}

Decision BandDecisions::within_at_end(const FencePiece& piece, const GapLimit& limit) {
  ++cost_.exact_tests;
  return within(placed_at(rows_, piece.mover, piece.mover_motion.to),
                placed_at(rows_, table_.carrier(piece.fence), piece.fence_motion.to), limit, walk_);
}

GapOptions BandDecisions::options_of(const FencePiece& piece, double from) {
  const double length_s = std::max(seconds_of(piece), wire_contract::kNanosecond_s);
  const std::uint32_t left = kBandLooksOfStep - std::min(kBandLooksOfStep, cost_.sweep_looks);
  return {.width = std::clamp(kBandSweepWidth_s / length_s, kNarrowestBracket, kWidestBracket),
          .from = from,
          .most_looks = std::clamp(left, kLeastBandLooks, kMostBandLooks),
          .looks = &cost_.sweep_looks};
}

GapTime BandDecisions::first_within(const FencePiece& piece, const GapLimit& limit, double from) {
  return engine::first_within(body_of(rows_, piece.mover, piece.mover_motion),
                              body_of(rows_, table_.carrier(piece.fence), piece.fence_motion), limit,
                              options_of(piece, from), walk_);
}

GapTime BandDecisions::first_beyond(const FencePiece& piece, const GapLimit& limit, double from) {
  return engine::first_beyond(body_of(rows_, piece.mover, piece.mover_motion),
                              body_of(rows_, table_.carrier(piece.fence), piece.fence_motion), limit,
                              options_of(piece, from), walk_);
}

/// Bracketed by the whole piece; callers who know a narrower bracket set it.
FoundContact BandDecisions::found_in(const FencePiece& piece) const {
  FoundContact found{.a = rows_.info(piece.mover)->id, .b = table_.id(piece.fence), .contact = {}};
  found.b_triangle = table_.rule(piece.fence).tells;
  found.bracket_low_s = step_.seconds_ago(piece.from_ns - clock_error_ns(piece));
  found.bracket_high_s = step_.seconds_ago(piece.to_ns + clock_error_ns(piece));
  found.parted_low_s = found.bracket_low_s;
  found.parted_high_s = found.bracket_high_s;
  return found;
}

/// With where the two are nearest, how far apart, how they move against each other, and when they would touch.
FoundContact BandDecisions::found_at(const FencePiece& piece, const GapTime& first) {
  FoundContact found = found_in(piece);
  found.contact = {.point = first.at.on_a,
                   .normal = first.at.normal,
                   .depth_m = -first.at.clearance_m,
                   .depth_error_m = first.at.error_m};
  found.surface = Contact{};
  found.surface->depth_error_m = std::numeric_limits<double>::infinity();
  const double piece_s = seconds_of(piece);
  if (!(piece_s > 0)) return found;
  const double t = first.yes ? first.bracket.high : 1;
  const double slack_s = (first.bracket.high - first.bracket.low) * piece_s + wire_contract::kNanosecond_s;
  set_velocity(found, piece.mover_motion.velocity(first.at.on_a, t, piece_s, slack_s),
               piece.fence_motion.velocity(first.at.on_b, t, piece_s, slack_s));
  predict(piece, t, found);
  return found;
}

/// When the two would touch if both went on as at time t: in found.surface, seconds from then, as a depth and its bound.
void BandDecisions::predict(const FencePiece& piece, double t, FoundContact& found) {
  const double piece_s = seconds_of(piece);
  const double turn_rad = std::max(piece.mover_motion.turn_rad, piece.fence_motion.turn_rad);
  const std::uint32_t carrier = table_.carrier(piece.fence);
  double ahead_s = turn_rad > 0 ? std::min(kPredicted_s, kPredictedTurn_rad / turn_rad * piece_s) : kPredicted_s;
  // Who has come past all of the other does not meet it any more; so short a motion rounds less.
  const double speed_mps = (piece.fence_motion.travel - piece.mover_motion.travel).norm() / piece_s;
  const double across_m = 2 * (rows_[piece.mover].reach_m + rows_[carrier].reach_m) - found.contact.depth_m;
  const bool is_endless = !rows_.bounds(carrier).low.allFinite() || !rows_.bounds(carrier).high.allFinite();
  if (!is_endless && turn_rad == 0 && across_m < 0.5 * kPredicted_s * speed_mps) ahead_s = 2 * across_m / speed_mps;
  const GapOptions options{.width = kPredictedWidth, .most_looks = kLeastBandLooks, .looks = &cost_.sweep_looks};
  const GapTime touch = engine::first_within(
      body_of(rows_, piece.mover, goes_on(piece.mover_motion, t, piece_s, ahead_s)),
      body_of(rows_, carrier, goes_on(piece.fence_motion, t, piece_s, ahead_s)), {0, 0}, options, walk_);
  if (!touch.yes) return;
  const double low_s = touch.bracket.low * ahead_s;
  const double high_s = touch.bracket.high * ahead_s;
  found.surface->depth_m = (low_s + high_s) / 2;
  found.surface->depth_error_m = (high_s - low_s) / 2 * (1 + kBoundSlack) + kRoundoff * 4 * high_s;
}

BracketNs BandDecisions::in_nanoseconds(const FencePiece& piece, const GapTime& time, bool is_reversed) const {
  TimeBracket bracket = time.bracket;
  if (is_reversed) bracket = {1 - bracket.high, 1 - bracket.low};
  BracketNs found = engine::in_nanoseconds(piece.from_ns, piece.to_ns, {piece.mover_motion, piece.fence_motion},
                                           bracket, time.at.on_a, time.at.normal);
  found.low_ns -= clock_error_ns(piece);
  found.high_ns += clock_error_ns(piece);
  return found;
}

std::int64_t BandDecisions::clock_error_ns(const FencePiece& piece) const {
  const std::uint32_t carrier = table_.carrier(piece.fence);
  const bool share = rows_.source(carrier) == Sources::kResting || rows_.source(carrier) == rows_.source(piece.mover);
  return share ? 0 : step_.options.clock_error_ns;
}

/// There is room for one more in a band; else the search is marked as cut short.
bool BandDecisions::may_begin() {
  cost_.truncated = cost_.truncated || ledger_.open().size() >= step_.options.max_contacts;
  return !cost_.truncated;
}

}  // namespace collided::engine
