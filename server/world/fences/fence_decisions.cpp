#include "server/world/fences/fence_decisions.hpp"

#include <algorithm>

#include "idl/glob.hpp"
#include "server/geometry/guess_tolerance.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/sweep.hpp"
#include "server/world/solids/within.hpp"

namespace collided::engine {
namespace {

/// Width of brackets: reported times are whole nanoseconds.
constexpr double kFenceSweepWidth_s = 1e-9;
/// Tests of pairs of parts that one sweep may take, and those of a step together before each has only the least.
constexpr std::uint32_t kMostFenceLooks = 10'000;
constexpr std::uint32_t kFenceLooksOfStep = 50'000;
constexpr std::uint32_t kLeastFenceLooks = 200;

const Pose kWorldPose;
const Frame kWorldFrame;

/// The box is upright and surely holds the point: a difference and a comparison round too little to matter.
bool surely_holds(const Box& box, const Vec3& point) {
  if (box.axes != Mat3::Identity()) return false;
  return ((point - box.center).cwiseAbs().array() * (1 + kFewSlack) < box.half_m.array()).all();
}

/// The whole object is one ball or box about its frame's origin, which then is a point of it.
bool is_about_origin(const ObjectInfo& info, const std::optional<Sphere>& ball) {
  if (ball) return ball->center.isZero(0);
  const Box* box = lone_box(info);
  return box != nullptr && box->center.isZero(0);
}

bool is_of(const std::string& glob, const ObjectInfo& info) { return wire_contract::glob_matches(glob, info.name); }

}  // namespace

bool FenceDecisions::looks_at(std::uint32_t fence, std::uint32_t mover) const {
  const ObjectInfo* info = rows_.info(mover);
  if (info == nullptr || !info->moving || table_.carrier(fence) == mover) return false;
  const FenceRule& rule = table_.rule(fence);
  if (!rule.skip.empty() && wire_contract::glob_matches(rule.skip, info->name)) return false;
  if (rule.band) return band_looks_at(fence, *info);
  if ((info->filter.layers & rule.mask) == 0) return false;
  return rule.only.empty() || wire_contract::glob_matches(rule.only, info->name);
}

/// A pair is reported once: where both objects have bands about them, by those of the name that comes first. Static objects
/// of either group have bands. The mask is one of moving objects of `only`, whichever of the two has the bands.
bool FenceDecisions::band_looks_at(std::uint32_t fence, const ObjectInfo& mover) const {
  const FenceRule& rule = table_.rule(fence);
  const ObjectInfo* about = rows_.info(table_.carrier(fence));
  if (about == nullptr) return false;
  const std::string& around = rule.band->around;
  const auto is_of_only = [&](const ObjectInfo& object) {
    return is_of(rule.only, object) && (!object.moving || (object.filter.layers & rule.mask) != 0);
  };
  const bool is_told_so = is_of(around, *about) && is_of_only(mover);
  const bool is_told_otherwise = is_of_only(*about) && is_of(around, mover);
  if (!about->moving) return is_told_so || is_told_otherwise;
  return is_told_so && !(is_told_otherwise && mover.name < about->name);
}

bool FenceDecisions::surely_stays(std::uint32_t fence, std::uint32_t mover) {
  if (table_.is_carried(fence) || !is_about_origin(*rows_.info(mover), rows_.lone_sphere(mover))) return false;
  const Box* box = lone_box(table_.body(fence));
  return box != nullptr && surely_holds(*box, rows_[mover].pose.position);
}

void FenceDecisions::decide(std::uint32_t fence, std::uint32_t mover, bool is_new) {
  ++cost_.candidate_pairs;
  if (is_new) return decide_new(fence, mover);
  if (!table_.is_carried(fence)) return decide_at_rest_in_the_world(fence, mover);
  const std::uint32_t carrier = table_.carrier(fence);
  if (carrier == FenceTable::kNone) return;
  if (are_on_common_time(step_, carrier, mover)) return decide_on_common_time(fence, mover, carrier);
  decide_carried(fence, mover, carrier);
}

/// Where the object was placed, only the place counts; else all of its motion.
void FenceDecisions::decide_at_rest_in_the_world(std::uint32_t fence, std::uint32_t mover) {
  if (!rows_.has_moved(mover)) return;
  const ObjectRow& row = rows_[mover];
  if (rows_.motion(mover) == Motion::placed) {
    const double at_s = step_.seconds_ago(row.posed_ns);
    return decide_instant(instant_now(fence, mover, row.posed_ns), {EndReason::teleported, at_s, at_s});
  }
  decide_piece({.mover = mover,
                .fence = fence,
                .from_ns = row.posed_before_ns > 0 ? row.posed_before_ns : row.posed_ns,
                .to_ns = row.posed_ns,
                .mover_motion = step_.motion.body_motion(mover),
                .fence_motion = BodyMotion::resting(kWorldFrame)});
}

/// Both are known up to the same instant, and whichever moved did so in the same time.
void FenceDecisions::decide_carried(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier) {
  const Motion how = std::max(rows_.motion(mover), rows_.motion(carrier));
  if (how == Motion::none) return;
  const ObjectRow& row = rows_[rows_.motion(mover) == how ? mover : carrier];
  if (how == Motion::placed) {
    const double at_s = step_.seconds_ago(row.posed_ns);
    return decide_instant(instant_now(fence, mover, row.posed_ns), {EndReason::teleported, at_s, at_s});
  }
  decide_piece(
      {.mover = mover,
       .fence = fence,
       .from_ns = row.posed_before_ns > 0 ? row.posed_before_ns : row.posed_ns,
       .to_ns = row.posed_ns,
       .mover_motion = step_.motion.body_motion(mover),
       .fence_motion = {rows_.motion(carrier) == Motion::moved ? rows_[carrier].frame_before() : rows_[carrier].frame(),
                        rows_[carrier].frame(), rows_.pivot(carrier)}});
}

void FenceDecisions::decide_on_common_time(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier) {
  const PairWindow window = window_of(step_, carrier, mover);
  const MotionHistory& history = step_.motion.history();
  const auto moves = [&](std::uint32_t slot) { return history.moves(slot, window.from_ns, window.to_ns); };
  const bool is_moved = moves(carrier) || moves(mover);
  if (window.is_empty() || !(window.is_closed || is_moved)) return;
  if (window.is_closed) {
    decide_instant(instant_on(fence, mover, carrier, window.from_ns),
                   {EndReason::separated, step_.seconds_ago(window.decided_ns), step_.seconds_ago(window.from_ns)});
  }
  if (window.to_ns <= window.from_ns) return;
  cut(step_, carrier, mover, window, lists_.cuts);
  std::int64_t from_ns = window.from_ns;
  for (const std::int64_t to_ns : lists_.cuts) {
    decide_piece({.mover = mover,
                  .fence = fence,
                  .from_ns = from_ns,
                  .to_ns = to_ns,
                  .mover_motion = history.motion(mover, from_ns, to_ns, rows_[mover].pose),
                  .fence_motion = history.motion(carrier, from_ns, to_ns, rows_[carrier].pose)});
    if (history.jumps(carrier, to_ns) || history.jumps(mover, to_ns)) {
      const double at_s = step_.seconds_ago(to_ns);
      decide_instant(instant_on(fence, mover, carrier, to_ns), {EndReason::teleported, at_s, at_s});
    }
    from_ns = to_ns;
  }
}

/// Decides where both are now, or at the newest instant known of both: nothing is said of the time before the fence.
void FenceDecisions::decide_new(std::uint32_t fence, std::uint32_t mover) {
  const std::uint32_t carrier = table_.carrier(fence);
  if (carrier != FenceTable::kNone && are_on_common_time(step_, carrier, mover)) {
    const std::int64_t known_ns = window_of(step_, carrier, mover).to_ns;
    const double at_s = step_.seconds_ago(known_ns);
    return decide_instant(instant_on(fence, mover, carrier, known_ns), {EndReason::separated, at_s, at_s});
  }
  decide_instant(instant_now(fence, mover, step_.world_time_ns), {EndReason::separated, 0, 0});
}

FencePiece FenceDecisions::instant_on(std::uint32_t fence, std::uint32_t mover, std::uint32_t carrier,
                                      std::int64_t time_ns) const {
  const MotionHistory& history = step_.motion.history();
  return {.mover = mover,
          .fence = fence,
          .from_ns = time_ns,
          .to_ns = time_ns,
          .mover_motion = BodyMotion::resting(history.at(mover, time_ns, rows_[mover].pose)),
          .fence_motion = BodyMotion::resting(history.at(carrier, time_ns, rows_[carrier].pose))};
}

FencePiece FenceDecisions::instant_now(std::uint32_t fence, std::uint32_t mover, std::int64_t time_ns) const {
  const std::uint32_t carrier = table_.carrier(fence);
  return {.mover = mover,
          .fence = fence,
          .from_ns = time_ns,
          .to_ns = time_ns,
          .mover_motion = BodyMotion::resting(rows_[mover].frame()),
          .fence_motion = BodyMotion::resting(carrier == FenceTable::kNone ? kWorldFrame : rows_[carrier].frame())};
}

/// Who is in goes out, stays, or is in doubt, which does not end it; who is not comes in within the piece or does not.
void FenceDecisions::decide_piece(const FencePiece& piece) {
  if (table_.is_band(piece.fence)) return bands_.decide_piece(piece);
  if (is_resting(piece.mover_motion) && is_resting(piece.fence_motion) && piece.from_ns < piece.to_ns) return;
  FoundContact found = found_in(piece);
  const bool is_held = ledger_.holds(found.a, found.b);
  if (!is_held && table_.is_carried(piece.fence) &&
      !overlaps(bounds(*rows_.info(piece.mover), piece.mover_motion, rows_[piece.mover].reach_m),
                bounds(table_.body(piece.fence), piece.fence_motion, table_.reach_m(piece.fence)))) {
    return ledger_.decided_apart(found.a, found.b, found.bracket_low_s, found.bracket_high_s);
  }
  bool is_within = false;
  const ContactSearch touch = touch_at_end(piece, is_within);
  if (touch.undecided && !touch.yes) ++cost_.undecided;
  SweptContact first;
  if (!is_held) {
    first = sweep(piece);
    ++cost_.swept;
  }
  if (decide_intervals(piece, touch, is_within, is_held ? nullptr : &first)) return;
  if (is_held && touch.yes) return;
  if (is_held) {
    if (touch.undecided) return ledger_.doubts(found, Doubt::numeric);
    const ContactEnd left = leaving(piece);
    return ledger_.parts(found.a, found.b, left.reason, left.bracket_low_s, left.bracket_high_s);
  }
  if (touch.yes || first.yes) {
    if (may_begin()) begin_in_motion(piece, touch, first);
  } else if (touch.undecided) {
    ledger_.doubts(found, Doubt::numeric);
  } else if (ledger_.is_in_doubt(found.a, found.b)) {
    ledger_.decided_apart(found.a, found.b, found.bracket_low_s, found.bracket_high_s);
  } else if (first.undecided && may_begin()) {
    ++cost_.sweeps_skipped;
    ledger_.doubted_and_parted(found, first.is_cut_short ? Doubt::cost_limit : Doubt::numeric);
  }
}

void FenceDecisions::begin_in_motion(const FencePiece& piece, const ContactSearch& touch, const SweptContact& first) {
  const ContactEnd came = in_seconds(piece, first.yes ? first.bracket : TimeBracket{0, 1}, first.contact);
  FoundContact found = found_in(piece);
  found.contact = first.contact;
  found.bracket_low_s = came.bracket_low_s;
  found.bracket_high_s = came.bracket_high_s;
  if (touch.yes || touch.undecided) return ledger_.touches(found);
  const ContactEnd left = leaving(piece);
  found.parted_low_s = std::min(left.bracket_low_s, found.bracket_low_s);
  found.parted_high_s = left.bracket_high_s;
  ledger_.touched_and_parted(found);
}

/// left: how it ends if the object was in and is not any more.
void FenceDecisions::decide_instant(const FencePiece& instant, const ContactEnd& left) {
  if (table_.is_band(instant.fence)) return bands_.decide_instant(instant, left);
  bool is_within = false;
  const ContactSearch touch = touch_at_end(instant, is_within);
  if (touch.undecided && !touch.yes) ++cost_.undecided;
  const FoundContact found = found_in(instant);
  const bool is_held = ledger_.holds(found.a, found.b);
  if (touch.yes && (is_held || may_begin())) {
    ledger_.touches(found);
  } else if (!touch.yes && touch.undecided) {
    ledger_.doubts(found, Doubt::numeric);
  } else if (is_held && !touch.yes) {
    ledger_.parts(found.a, found.b, left.reason, left.bracket_low_s, left.bracket_high_s);
  } else if (!touch.yes) {
    ledger_.decided_apart(found.a, found.b, left.bracket_low_s, left.bracket_high_s);
  }
}

Placed FenceDecisions::placed_fence(std::uint32_t fence, const Frame& frame) {
  const std::uint32_t carrier = table_.carrier(fence);
  const ObjectInfo& body = table_.body(fence);
  Placed placed{.info = &body, .frame = frame, .bounds = {}, .pose = nullptr};
  if (carrier == FenceTable::kNone) placed.pose = &kWorldPose;
  else if (is_same(frame, rows_[carrier].frame())) placed.pose = &rows_[carrier].pose;
  placed.bounds = carrier == FenceTable::kNone ? table_.bounds(fence) : bounds_of(body, frame);
  return placed;
}

/// Of two whose surfaces do not meet: whether the outer one, a solid mesh, has some of the inner one within it.
bool FenceDecisions::holds_a_piece(const Placed& outer, const Placed& inner, PiecePoints& points) {
  if (!outer.info->rare->solid) return false;
  Deadline never;
  return pieces_within(*outer.info->rare->solid, outer, inner, points.of(*inner.info), never, walk_, cost_.exact_tests)
      .some;
}

/// is_within  becomes true where the two touch though their surfaces do not
ContactSearch FenceDecisions::touch_at_end(const FencePiece& piece, bool& is_within) {
  ContactSearch touch = touch_surfaces(piece, piece.mover_motion.to, piece.fence_motion.to);
  is_within = !touch.yes && is_within_at(piece, 1);
  touch.yes = touch.yes || is_within;
  return touch;
}

ContactSearch FenceDecisions::touch_surfaces(const FencePiece& piece, const Frame& mover_frame,
                                             const Frame& fence_frame) {
  ContactSearch touch;
  touch.wanted = is_cut(piece);
  const bool with_bounds = !is_ball_or_box(*rows_.info(piece.mover)) || !is_ball_or_box(table_.body(piece.fence));
  const Placed mover = placed_at(rows_, piece.mover, mover_frame, with_bounds);
  const Placed fence = placed_fence(piece.fence, fence_frame);
  if (with_bounds && !overlaps(mover.bounds, fence.bounds)) return touch;
  search_objects(mover, fence, touch, walk_);
  cost_.exact_tests += touch.exact_tests;
  return touch;
}

/// Of two whose surfaces do not touch at that time: one holds some of the other.
bool FenceDecisions::is_within_at(const FencePiece& piece, double t) {
  if (!rows_.info(piece.mover)->rare->solid && !table_.body(piece.fence).rare->solid) return false;
  const Placed mover = placed_at(rows_, piece.mover, piece.mover_motion.at(t));
  const Placed fence = placed_fence(piece.fence, piece.fence_motion.at(t));
  if (!overlaps(mover.bounds, fence.bounds)) return false;
  return holds_a_piece(fence, mover, lists_.mover_points) || holds_a_piece(mover, fence, lists_.fence_points);
}

/// The first time in the piece at which the two meet.
SweptContact FenceDecisions::sweep(const FencePiece& piece) {
  if (piece.fence_motion.turn_rad == 0) {
    if (const std::optional<SweptContact> found = sweep_sphere(piece, true)) return *found;
  }
  if (piece.mover_motion.turn_rad == 0) {
    if (const std::optional<SweptContact> found = sweep_sphere(piece, false)) return turned_round(*found);
  }
  return sweep_span(piece, {0, 1});
}

double FenceDecisions::bracket_width(const FencePiece& piece) const {
  const double length_s =
      static_cast<double>(std::max<std::int64_t>(piece.to_ns - piece.from_ns, 1)) * wire_contract::kNanosecond_s;
  return std::clamp(kFenceSweepWidth_s / length_s, kNarrowestBracket, kWidestBracket);
}

SweptContact FenceDecisions::sweep_span(const FencePiece& piece, const TimeSpan& span) {
  SweptContact touch;
  const std::uint32_t left = kFenceLooksOfStep - std::min(kFenceLooksOfStep, cost_.sweep_looks);
  const SweepOptions options{.width = bracket_width(piece),
                             .span = span,
                             .contacts = true,
                             .most_looks = std::clamp(left, kLeastFenceLooks, kMostFenceLooks),
                             .looks = &cost_.sweep_looks};
  engine::sweep(SweptBody(*rows_.info(piece.mover), piece.mover_motion),
                SweptBody(table_.body(piece.fence), piece.fence_motion), options, walk_, touch);
  cost_.exact_tests += touch.exact_tests;
  return touch;
}

/// The exact sweep of the one's sphere along its motion relative to the other; nothing where it is no lone sphere.
std::optional<SweptContact> FenceDecisions::sweep_sphere(const FencePiece& piece, bool is_mover) {
  const std::optional<Sphere> sphere =
      is_mover ? rows_.lone_sphere(piece.mover) : lone_sphere(table_.body(piece.fence));
  if (!sphere) return std::nullopt;
  const BodyMotion& motion = is_mover ? piece.mover_motion : piece.fence_motion;
  const BodyMotion& others = is_mover ? piece.fence_motion : piece.mover_motion;
  // The centre moves straight only where the body does not rotate about another point.
  if (motion.turn_rad != 0 && (!sphere->center.isZero(0) || motion.pivot_m > 0)) return std::nullopt;
  SphereSweep sweep{.mover = {.start = place(motion.from, sphere->center) + others.travel,
                              .end = place(motion.to, sphere->center),
                              .radius_m = sphere->radius_m},
                    .width = step_.options.sweep_width};
  sweep_object(sweep, is_mover ? placed_fence(piece.fence, others.to) : placed_at(rows_, piece.mover, others.to, false),
               walk_);
  cost_.exact_tests += sweep.found.exact_tests;
  return sweep.found;
}

/// When an object that is not in any more left: the first contact of the reversed motion.
ContactEnd FenceDecisions::leaving(const FencePiece& piece) {
  const SweptContact last = sweep(piece.reversed());
  const TimeBracket bracket = last.yes ? TimeBracket{1 - last.bracket.high, 1 - last.bracket.low} : TimeBracket{0, 1};
  return in_seconds(piece, bracket, last.contact);
}

ContactEnd FenceDecisions::in_seconds(const FencePiece& piece, const TimeBracket& bracket, const Contact& at) const {
  const BracketNs found = in_nanoseconds(piece.from_ns, piece.to_ns, {piece.mover_motion, piece.fence_motion}, bracket,
                                         at.point, at.normal);
  const std::int64_t error_ns = clock_error_ns(piece);
  return {.reason = EndReason::separated,
          .bracket_low_s = step_.seconds_ago(found.low_ns - error_ns),
          .bracket_high_s = step_.seconds_ago(found.high_ns + error_ns)};
}

/// A fence in the world has the clock of whoever moves; one that an object carries has its publisher's.
std::int64_t FenceDecisions::clock_error_ns(const FencePiece& piece) const {
  const std::uint32_t carrier = table_.carrier(piece.fence);
  const bool share = carrier == FenceTable::kNone || rows_.source(carrier) == rows_.source(piece.mover);
  return share ? 0 : step_.options.clock_error_ns;
}

/// Bracketed by the whole piece; callers who know a narrower bracket set it.
FoundContact FenceDecisions::found_in(const FencePiece& piece) const {
  FoundContact found{.a = rows_.info(piece.mover)->id, .b = table_.id(piece.fence), .contact = {}};
  // What the fence tells travels with its events.
  found.b_triangle = table_.rule(piece.fence).tells;
  found.bracket_low_s = step_.seconds_ago(piece.from_ns - clock_error_ns(piece));
  found.bracket_high_s = step_.seconds_ago(piece.to_ns + clock_error_ns(piece));
  found.parted_low_s = found.bracket_low_s;
  found.parted_high_s = found.bracket_high_s;
  return found;
}

/// There is room for one more in a fence; else the search is marked as cut short.
bool FenceDecisions::may_begin() {
  cost_.truncated = cost_.truncated || ledger_.open().size() >= step_.options.max_contacts;
  return !cost_.truncated;
}

}  // namespace collided::engine
