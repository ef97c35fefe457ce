// Pairs whose objects are known up to different times: decided on the time known of both, piece by piece, independent
// of how that time was spread over steps.

#include <algorithm>
#include <cmath>

#include "idl/clocks.hpp"
#include "server/exact_phase/motion/ball_motion_filter.hpp"
#include "server/exact_phase/motion/box_motion_filter.hpp"
#include "server/geometry/guess_tolerance.hpp"
#include "server/world/objects/object_placing.hpp"
#include "server/world/step/decisions.hpp"

namespace collided::engine {
namespace {

/// Width of brackets: reported times are whole nanoseconds. Much shorter contacts come out undecided.
constexpr double kSweepWidth_s = 1e-9;

bool rests(const BodyMotion& path) { return path.turn_rad == 0 && path.from.position == path.to.position; }

/// The velocity of the object's point that is at `point` at that time; an object without a segment rests.
BodyMotion::PointVelocity velocity_on(const MotionSegment* segment, const Vec3& point, std::int64_t time_ns,
                                      double slack_s) {
  if (segment == nullptr) return {};
  const double length_ns = static_cast<double>(segment->to_ns - segment->from_ns);
  return segment->path().velocity(point, static_cast<double>(time_ns - segment->from_ns) / length_ns,
                                  length_ns * wire_contract::kNanosecond_s, slack_s);
}

}  // namespace

void Decisions::decide_on_common_time(std::uint32_t first, std::uint32_t second) {
  if (rows_.info(second)->id < rows_.info(first)->id) std::swap(first, second);
  if (ways_stay_apart(first, second) && !ledger_.is_open(rows_.info(first)->id, rows_.info(second)->id)) {
    ++cost_.candidate_pairs;
    return;
  }
  const PairWindow window = window_of(step_, first, second);
  const MotionHistory& history = step_.motion.history();
  const auto moves = [&](std::uint32_t slot) { return history.moves(slot, window.from_ns, window.to_ns); };
  const bool is_moved = moves(first) || moves(second);
  if (window.is_empty() || !(window.is_closed || is_moved)) return;
  ++cost_.candidate_pairs;
  if (window.is_closed) begin_window(first, second, window);
  if (window.to_ns <= window.from_ns) return;
  cut(step_, first, second, window, lists_.cuts);
  std::int64_t from_ns = window.from_ns;
  const bool are_balls = rows_[first].is_lone_sphere() && rows_[second].is_lone_sphere();
  bool is_open = ledger_.is_open(rows_.info(first)->id, rows_.info(second)->id);
  for (const std::int64_t to_ns : lists_.cuts) {
    // For two spheres, their centres alone rule out most pieces of most candidates.
    if (is_open || !are_balls || !balls_stay_apart(first, second, from_ns, to_ns)) {
      is_open = decide_piece({.a = first,
                              .b = second,
                              .from_ns = from_ns,
                              .to_ns = to_ns,
                              .a_motion = history.motion(first, from_ns, to_ns, rows_[first].pose),
                              .b_motion = history.motion(second, from_ns, to_ns, rows_[second].pose)});
    }
    if (history.jumps(first, to_ns) || history.jumps(second, to_ns)) {
      const double at_s = seconds_ago(to_ns);
      is_open = decide_instant(first, second, to_ns, {EndReason::teleported, at_s, at_s});
    }
    from_ns = to_ns;
  }
}

/// An open contact continues, ends, or is in doubt, which does not end it; without one, a contact begins within the
/// piece or does not. True: the pair is in contact or in doubt.
bool Decisions::decide_piece(const PairPiece& piece) {
  const ObjectId a = rows_.info(piece.a)->id;
  const ObjectId b = rows_.info(piece.b)->id;
  const bool is_held = ledger_.holds(a, b);
  const bool is_in_doubt = ledger_.is_in_doubt(a, b);
  if (rests(piece.a_motion) && rests(piece.b_motion)) return is_held || is_in_doubt;
  if (!is_held && surely_stay_apart(piece)) {
    ledger_.decided_apart(a, b, seconds_ago(piece.from_ns), seconds_ago(piece.to_ns));
    return false;
  }
  WithinSolid within;
  const ContactSearch touch = touch_at_end(piece, within);
  const Contained contained = within.contained;
  if (touch.undecided && !touch.yes) ++cost_.undecided;
  SweptContact sweep;
  if (!is_held) {
    sweep = sweep_piece(piece);
    ++cost_.swept;
  }
  if (decide_intervals(piece, touch, within, is_held ? nullptr : &sweep)) return ledger_.is_open(a, b);
  if (is_held && touch.yes) {
    FoundContact found = found_at(piece, touch.a_triangle, touch.b_triangle, touch.contact, 1);
    found.contained = contained;
    set_change_of_containment(piece, found);
    ledger_.touches(found);
    ++cost_.contacts;
  } else if (is_held && !touch.undecided) {
    if (ledger_.contained(a, b) != Contained::none) ledger_.changes_containment(a, b, Contained::none, emerging(piece));
    const ContactEnd end = parting(piece);
    ledger_.parts(a, b, end.reason, end.bracket_low_s, end.bracket_high_s);
  } else if (!is_held) {
    if (sweep.undecided && !sweep.yes && !touch.yes) ++cost_.sweeps_skipped;
    if (!touch.yes && !sweep.yes) doubt_piece(piece, touch, sweep);
    else if (may_begin()) begin_in_motion(piece, touch, sweep, contained);
  }
  return ledger_.is_open(a, b);
}

/// The pair was found neither to touch nor to be apart, at the piece's end or within it; or an earlier doubt is over.
void Decisions::doubt_piece(const PairPiece& piece, const ContactSearch& touch, const SweptContact& sweep) {
  FoundContact found{.a = rows_.info(piece.a)->id,
                     .b = rows_.info(piece.b)->id,
                     .contact = {},
                     .bracket_low_s = seconds_ago(piece.from_ns),
                     .bracket_high_s = seconds_ago(piece.to_ns),
                     .parted_low_s = seconds_ago(piece.from_ns),
                     .parted_high_s = seconds_ago(piece.to_ns)};
  if (touch.undecided) {
    ledger_.doubts(found, Doubt::numeric);
  } else if (ledger_.is_in_doubt(found.a, found.b)) {
    ledger_.decided_apart(found.a, found.b, found.bracket_low_s, found.bracket_high_s);
  } else if (sweep.undecided && may_begin()) {
    ledger_.doubted_and_parted(found, sweep.is_cut_short ? Doubt::cost_limit : Doubt::numeric);
  }
}

/// A contact begins within the piece; if the pair is apart at the end, it also ends there.
void Decisions::begin_in_motion(const PairPiece& piece, const ContactSearch& touch, const SweptContact& sweep,
                                Contained contained) {
  ++cost_.contacts;
  const PieceBracket first = in_seconds(piece, sweep.yes ? sweep.bracket : TimeBracket{0, 1}, sweep.contact);
  if (touch.yes || touch.undecided) {
    // Once touching, a pair stays in contact until it is known to be apart.
    FoundContact found = touch.yes
                             ? found_at(piece, touch.a_triangle, touch.b_triangle, touch.contact, 1)
                             : found_at(piece, sweep.a_triangle, sweep.b_triangle, sweep.contact, sweep.bracket.high);
    found.bracket_low_s = first.low_s;
    found.bracket_high_s = first.high_s;
    found.contained = contained;
    if (contained != Contained::none) {
      const ContactEnd parted = parting(piece);
      found.parted_low_s = std::min(parted.bracket_low_s, found.bracket_low_s);
      found.parted_high_s = parted.bracket_high_s;
    }
    ledger_.touches(found);
    return;
  }
  FoundContact found = found_at(piece, sweep.a_triangle, sweep.b_triangle, sweep.contact, sweep.bracket.high);
  found.bracket_low_s = first.low_s;
  found.bracket_high_s = first.high_s;
  const ContactEnd end = parting(piece);
  found.parted_low_s = std::min(end.bracket_low_s, found.bracket_low_s);
  found.parted_high_s = end.bracket_high_s;
  ledger_.touched_and_parted(found);
}

/// When the pair separated: the piece's last contact is the first one of the reversed motion.
ContactEnd Decisions::parting(const PairPiece& piece) {
  const SweptContact back = sweep_piece(piece.reversed(), !piece.is_of_step);
  const TimeBracket bracket = back.yes ? TimeBracket{1 - back.bracket.high, 1 - back.bracket.low} : TimeBracket{0, 1};
  const PieceBracket found = in_seconds(piece, bracket, back.contact);
  return {.reason = EndReason::separated, .bracket_low_s = found.low_s, .bracket_high_s = found.high_s};
}

/// A bracket within the motions of one step is that of the motions as placed.
Decisions::PieceBracket Decisions::in_seconds(const PairPiece& piece, const TimeBracket& bracket,
                                              const Contact& at) const {
  if (piece.is_of_step) return in_seconds(piece, rounded_outward(piece.from_ns, piece.to_ns, bracket));
  return in_seconds(piece, in_nanoseconds(piece.from_ns, piece.to_ns, {piece.a_motion, piece.b_motion}, bracket,
                                          at.point, at.normal));
}

Decisions::PieceBracket Decisions::in_seconds(const PairPiece& piece, const BracketNs& found) const {
  const std::int64_t error_ns = clock_error_ns(piece.a, piece.b);
  const PieceBracket in_s{.low_s = seconds_ago(found.low_ns - error_ns),
                          .high_s = seconds_ago(found.high_ns + error_ns)};
  if (piece.is_timed) return in_s;
  return {.low_s = std::max(0.0, in_s.low_s), .high_s = std::max(0.0, in_s.high_s)};
}

/// Objects of one publisher share one clock.
std::int64_t Decisions::clock_error_ns(std::uint32_t a, std::uint32_t b) const {
  return rows_.source(a) == rows_.source(b) ? 0 : step_.options.clock_error_ns;
}

/// Ends a contact that was open when the known time ended and is not where known time continues.
void Decisions::begin_window(std::uint32_t first, std::uint32_t second, const PairWindow& window) {
  const ContactEnd parted{.reason = EndReason::separated,
                          .bracket_low_s = seconds_ago(window.decided_ns),
                          .bracket_high_s = seconds_ago(window.from_ns)};
  decide_instant(first, second, window.from_ns, parted);
}

/// Decides the pair at the newest instant known of both, even if neither moved since the last decision.
void Decisions::decide_where_known(std::uint32_t first, std::uint32_t second) {
  if (rows_.info(second)->id < rows_.info(first)->id) std::swap(first, second);
  const std::int64_t time_ns = window_of(step_, first, second).to_ns;
  const double at_s = seconds_ago(time_ns);
  decide_instant(first, second, time_ns, {EndReason::separated, at_s, at_s});
}

/// Decides whether the two touch at one instant. parted: how a contact ends that was open until then. True: the pair is
/// in contact or in doubt.
bool Decisions::decide_instant(std::uint32_t a, std::uint32_t b, std::int64_t time_ns, const ContactEnd& parted) {
  const MotionHistory& history = step_.motion.history();
  const PairPiece instant{.a = a,
                          .b = b,
                          .from_ns = time_ns,
                          .to_ns = time_ns,
                          .a_motion = BodyMotion::resting(history.at(a, time_ns, rows_[a].pose)),
                          .b_motion = BodyMotion::resting(history.at(b, time_ns, rows_[b].pose))};
  WithinSolid within;
  const ContactSearch touch = touch_at_end(instant, within);
  if (touch.undecided && !touch.yes) ++cost_.undecided;
  const bool is_held = ledger_.holds(rows_.info(a)->id, rows_.info(b)->id);
  if (touch.yes && (is_held || may_begin())) {
    ++cost_.contacts;
    FoundContact found = found_at(instant, touch.a_triangle, touch.b_triangle, touch.contact, 1);
    found.contained = within.contained;
    found.parted_low_s = found.bracket_low_s;
    found.parted_high_s = found.bracket_high_s;
    ledger_.touches(found);
  } else if (is_held && !touch.undecided) {
    const double error_s = wire_contract::kNanosecond_s * static_cast<double>(clock_error_ns(a, b));
    ledger_.parts(rows_.info(a)->id, rows_.info(b)->id, parted.reason, parted.bracket_low_s + error_s,
                  parted.bracket_high_s - error_s);
  } else if (!touch.yes && touch.undecided) {
    ledger_.doubts(found_at(instant, touch.a_triangle, touch.b_triangle, touch.contact, 1), Doubt::numeric);
  } else if (!touch.yes) {
    ledger_.decided_apart(rows_.info(a)->id, rows_.info(b)->id, parted.bracket_low_s, parted.bracket_high_s);
  }
  return ledger_.is_open(rows_.info(a)->id, rows_.info(b)->id);
}

/// Tests the two objects at the end of the piece.
ContactSearch Decisions::touch_at_end(const PairPiece& piece, WithinSolid& within) {
  return touch_at(piece, piece.a_motion.to, piece.b_motion.to, &within);
}

/// Tests the two objects at two frames: their surfaces, and unless `within` is null also containment in a solid.
ContactSearch Decisions::touch_at(const PairPiece& piece, const Frame& frame_a, const Frame& frame_b,
                                  WithinSolid* within) {
  if (piece.scene != nullptr)
    return touch_part(piece, rows_.info(piece.a)->scene_part == kNoScenePart ? frame_a : frame_b, within);
  ContactSearch touch;
  touch.wanted = step_.step_options.contacts || is_cut(piece);
  const bool are_simple = are_balls_or_boxes(piece.a, piece.b);
  const auto placed_at = [&](std::uint32_t slot, const Frame& frame) {
    // A frame between two poses is interpolated: no pose was given for it.
    const ObjectRow& row = rows_[slot];
    const bool is_given = frame.position == row.pose.position && frame.rotation == row.frame().rotation;
    return Placed{.info = rows_.info(slot),
                  .frame = frame,
                  .bounds = are_simple ? Aabb{}
                            : is_given ? motion_.pose_bounds(slot)
                                       : bounds_of(*rows_.info(slot), frame),
                  .pose = is_given ? &row.pose : nullptr};
  };
  const Placed a = placed_at(piece.a, frame_a);
  const Placed b = placed_at(piece.b, frame_b);
  if (are_simple || overlaps(a.bounds, b.bounds)) search_objects(a, b, touch, walk_);
  cost_.exact_tests += touch.exact_tests;
  if (within == nullptr || touch.yes) return touch;
  within->contained = look_within(a, b, touch);
  within->is_some = touch.yes;
  return touch;
}

/// The first contact within a piece. A sphere against an object that does not rotate is swept exactly along its
/// relative motion; all else by the general sweep.
///
/// with_contact  computes the contact, not only its time
SweptContact Decisions::sweep_piece(const PairPiece& piece, bool with_contact) {
  if (piece.scene != nullptr) return sweep_part_piece(piece, {0, 1}, bracket_width(piece));
  if (piece.b_motion.turn_rad == 0) {
    if (const std::optional<SweptContact> found = sweep_sphere_piece(piece, true, with_contact)) return *found;
  }
  if (piece.a_motion.turn_rad == 0) {
    if (const std::optional<SweptContact> found = sweep_sphere_piece(piece, false, with_contact))
      return turned_round(*found);
  }
  return sweep_span(SweptBody(*rows_.info(piece.a), piece.a_motion), SweptBody(*rows_.info(piece.b), piece.b_motion),
                    {0, 1}, bracket_width(piece), with_contact);
}

/// The first contact of two bodies within a span of their motions.
SweptContact Decisions::sweep_span(const SweptBody& a, const SweptBody& b, const TimeSpan& span, double width,
                                   bool with_contact) {
  SweptContact touch;
  const SweepOptions options{
      .width = width, .span = span, .contacts = with_contact, .most_looks = sweep_looks(), .looks = &cost_.sweep_looks};
  sweep(a, b, options, walk_, touch);
  cost_.exact_tests += touch.exact_tests;
  return touch;
}

double Decisions::bracket_width(const PairPiece& piece) const {
  const double length_s = static_cast<double>(piece.to_ns - piece.from_ns) * wire_contract::kNanosecond_s;
  const double width_s = piece.is_of_step ? step_.options.sweep_width_s : kSweepWidth_s;
  return std::clamp(width_s / length_s, kNarrowestBracket, kWidestBracket);
}

/// The exact sweep of one object's sphere against the other; nothing if that object is not a lone sphere.
std::optional<SweptContact> Decisions::sweep_sphere_piece(const PairPiece& piece, bool a_is_sphere, bool with_contact) {
  const std::uint32_t other = a_is_sphere ? piece.b : piece.a;
  const BodyMotion& path = a_is_sphere ? piece.a_motion : piece.b_motion;
  const BodyMotion& others = a_is_sphere ? piece.b_motion : piece.a_motion;
  const std::optional<Sphere> sphere = rows_.lone_sphere(a_is_sphere ? piece.a : piece.b);
  if (!sphere) return std::nullopt;
  SphereSweep sweep{.mover = {.start = place(path.from, sphere->center) + others.travel,
                              .end = place(path.to, sphere->center),
                              .radius_m = sphere->radius_m},
                    .width = step_.options.sweep_width,
                    .contacts = with_contact};
  const Placed at_end{
      .info = rows_.info(other), .frame = others.to, .bounds = bounds_of(*rows_.info(other), others.to)};
  sweep_object(sweep, at_end, walk_);
  cost_.exact_tests += sweep.found.exact_tests;
  return sweep.found;
}

/// True if two lone spheres certainly do not meet, wherever each is on its newest path at any undecided time.
bool Decisions::ways_stay_apart(std::uint32_t a, std::uint32_t b) const {
  const BallMotion& way = motion_.ball(a);
  const BallMotion& other = motion_.ball(b);
  if (way.radius_m < 0 || other.radius_m < 0) return false;
  const MotionHistory& history = step_.motion.history();
  if (!history.is_on_one_way(a) || !history.is_on_one_way(b)) return false;
  // Twice the distance of the midpoints, and twice how far the balls reach from there.
  const Vec3 between = (way.start + way.end) - (other.start + other.end);
  const double reach_m =
      (way.end - way.start).norm() + (other.end - other.start).norm() + 2 * way.radius_m + 2 * other.radius_m;
  constexpr double kRoundings = 0x1p-46;
  const double size_m = way.start.lpNorm<1>() + way.end.lpNorm<1>() + other.start.lpNorm<1>() + other.end.lpNorm<1>();
  return between.norm() > reach_m * (1 + kRoundings) + kRoundings * size_m;
}

/// True if two lone spheres certainly do not meet in this time, judged by their centres alone.
bool Decisions::balls_stay_apart(std::uint32_t a, std::uint32_t b, std::int64_t from_ns, std::int64_t to_ns) const {
  const MotionHistory& history = step_.motion.history();
  const Sphere ball = *rows_.lone_sphere(a);
  const Sphere other = *rows_.lone_sphere(b);
  const MotionHistory::PointMotion path = history.center_motion(a, ball.center, from_ns, to_ns, rows_[a].pose);
  const MotionHistory::PointMotion others = history.center_motion(b, other.center, from_ns, to_ns, rows_[b].pose);
  return kernel::surely_apart(
      {.start = path.from + (others.to - others.from), .end = path.to, .radius_m = ball.radius_m},
      {.center = others.to, .radius_m = other.radius_m});
}

/// True if a plane separates the two motions, or their bounds do not overlap.
bool Decisions::surely_stay_apart(const PairPiece& piece) const {
  const Box* a = lone_box(*rows_.info(piece.a));
  const Box* b = lone_box(*rows_.info(piece.b));
  if (a != nullptr && b != nullptr) {
    return kernel::surely_apart(kernel::MovingBox(*a, piece.a_motion.from, piece.a_motion.to, rows_[piece.a].reach_m),
                                kernel::MovingBox(*b, piece.b_motion.from, piece.b_motion.to, rows_[piece.b].reach_m));
  }
  return !overlaps(bounds(*rows_.info(piece.a), piece.a_motion, rows_[piece.a].reach_m),
                   bounds(*rows_.info(piece.b), piece.b_motion, rows_[piece.b].reach_m));
}

/// The error of placing both anywhere in the piece: at most that of the worse end, plus the motion's own error.
double Decisions::placing_error_on(const PairPiece& piece, std::uint32_t a_triangle, std::uint32_t b_triangle) const {
  const bool are_simple = are_balls_or_boxes(piece.a, piece.b);
  const auto unplaced = [&](std::uint32_t slot) {
    return Placed{.info = rows_.info(slot),
                  .frame = {},
                  .bounds = are_simple ? Aabb{} : motion_.pose_bounds(slot),
                  .pose = &rows_[slot].pose};
  };
  Placed a = unplaced(piece.a);
  Placed b = unplaced(piece.b);
  const auto at = [&](const Frame& frame_a, const Frame& frame_b) {
    a.frame = frame_a;
    b.frame = frame_b;
    return placing_error_m(a, a_triangle, b, b_triangle);
  };
  const double motion_m =
      piece.a_motion.error_m(rows_[piece.a].reach_m) + piece.b_motion.error_m(rows_[piece.b].reach_m);
  return std::max(at(piece.a_motion.from, piece.b_motion.from), at(piece.a_motion.to, piece.b_motion.to)) + motion_m;
}

/// The contact at a fraction of the piece, bracketed by the whole piece; callers with a narrower bracket set it.
///
/// known_slack_s  uncertainty of the time; default: the length of the piece
FoundContact Decisions::found_at(const PairPiece& piece, std::uint32_t a_triangle, std::uint32_t b_triangle,
                                 const Contact& contact, double time, std::optional<double> known_slack_s) {
  const std::int64_t time_ns = piece.from_ns + std::llround(time * static_cast<double>(piece.to_ns - piece.from_ns));
  const MotionHistory& history = step_.motion.history();
  FoundContact found{.a = rows_.info(piece.a)->id,
                     .b = rows_.info(piece.b)->id,
                     .a_triangle = a_triangle,
                     .b_triangle = b_triangle,
                     .contact = contact,
                     .bracket_low_s = seconds_ago(piece.from_ns - clock_error_ns(piece.a, piece.b)),
                     .bracket_high_s = seconds_ago(piece.to_ns + clock_error_ns(piece.a, piece.b))};
  if (step_.step_options.contacts) {
    found.contact.depth_error_m +=
        piece.is_of_step ? placing_error_of(found) : placing_error_on(piece, a_triangle, b_triangle);
    // A contact that continues without an event needs no velocity.
    if (!step_.step_options.persisted && ledger_.holds(found.a, found.b)) return found;
    const double slack_s =
        known_slack_s.value_or(wire_contract::kNanosecond_s * static_cast<double>(piece.to_ns - piece.from_ns));
    const auto velocity = [&](std::uint32_t slot) {
      return piece.is_of_step ? velocity_at(contact.point, slot, time, slack_s)
                              : velocity_on(history.under_way(slot, time_ns), contact.point, time_ns, slack_s);
    };
    set_velocity(found, velocity(piece.a), velocity(piece.b));
  }
  return found;
}

/// True if there is room for one more contact; else marks the search as cut short.
bool Decisions::may_begin() {
  cost_.truncated = cost_.truncated || ledger_.is_full(step_.options.max_contacts);
  return !cost_.truncated;
}

}  // namespace collided::engine
