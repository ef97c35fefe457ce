#include "server/world/fences/band_predicate.hpp"

#include <algorithm>
#include <limits>

#include "server/geometry/tolerance.hpp"
#include "server/world/objects/contact_times.hpp"
#include "server/world/objects/sweep.hpp"

namespace collided::engine {
namespace {

constexpr LookBudget kBandLooks{.most = 2'000, .of_step = 200'000, .least = 200};
/// How far ahead a contact is predicted, and the width of its bracket as a fraction of that.
constexpr double kPredicted_s = 60;
constexpr double kPredictedWidth = 1e-9;
constexpr double kPredictedTurn_rad = 1.5;

/// The body's motion continued from time t of a piece of that length, for this many seconds.
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

bool BandPredicate::may_hold(const StandingPiece& piece) const {
  const std::uint32_t carrier = table_.carrier(piece.fence);
  const Aabb mover = bounds(*rows_.info(piece.mover), piece.mover_motion, rows_[piece.mover].reach_m);
  const Aabb about = bounds(*rows_.info(carrier), piece.fence_motion, rows_[carrier].reach_m);
  return overlaps(mover, grown(about, table_.beyond_m(piece.fence)));
}

/// The distance of two single convex objects that move straight has one minimum, so they enter and leave once. At a
/// distance of 0 any overlap may be a rounding, and no search finds where it ends.
bool BandPredicate::may_turn_back(const StandingPiece& piece) const {
  return rule(piece).stays_in().low_m() > 0 &&
         !touch_at_most_once(*rows_.info(piece.mover), piece.mover_motion, *rows_.info(table_.carrier(piece.fence)),
                             piece.fence_motion);
}

Decision BandPredicate::at_end(const StandingPiece& piece, bool was_in) {
  ++cost_.exact_tests;
  return within(placed_at(rows_, piece.mover, piece.mover_motion.to),
                placed_at(rows_, table_.carrier(piece.fence), piece.fence_motion.to),
                was_in ? rule(piece).stays_in() : rule(piece).comes_in(), walk_);
}

GapOptions BandPredicate::options_of(const StandingPiece& piece, double from) {
  return {.width = bracket_width(piece.from_ns, piece.to_ns),
          .from = from,
          .most_looks = kBandLooks.after(cost_.sweep_looks),
          .looks = &cost_.sweep_looks};
}

GapBody BandPredicate::body_of(std::uint32_t slot, const BodyMotion& motion) const {
  return {.info = rows_.info(slot),
          .motion = motion,
          .reach_m = motion.turn_rad > 0 ? motion.lever_m(rows_[slot].reach_m) : 0};
}

GapTime BandPredicate::first_within(const StandingPiece& piece, const GapLimit& limit, double from) {
  return engine::first_within(body_of(piece.mover, piece.mover_motion),
                              body_of(table_.carrier(piece.fence), piece.fence_motion), limit, options_of(piece, from),
                              walk_);
}

GapTime BandPredicate::first_within(const StandingPiece& piece, double from) {
  return first_within(piece, rule(piece).comes_in(), from);
}

GapTime BandPredicate::first_beyond(const StandingPiece& piece, double from) {
  return engine::first_beyond(body_of(piece.mover, piece.mover_motion),
                              body_of(table_.carrier(piece.fence), piece.fence_motion), rule(piece).stays_in(),
                              options_of(piece, from), walk_);
}

/// first_within() of the reversed motion.
GapTime BandPredicate::last_within(const StandingPiece& piece) {
  GapTime last = first_within(piece.reversed(), rule(piece).stays_in(), 0);
  last.bracket = reversed(last.bracket);
  return last;
}

void BandPredicate::describe(const StandingPiece& piece, const GapTime& first, FoundContact& found) {
  found.contact = {.point = first.at.on_a,
                   .normal = first.at.normal,
                   .depth_m = -first.at.clearance_m,
                   .depth_error_m = first.at.error_m};
  found.surface = Contact{};
  found.surface->depth_error_m = std::numeric_limits<double>::infinity();
  const double piece_s = piece.seconds();
  if (!(piece_s > 0)) return;
  const double t = first.yes ? first.bracket.high : 1;
  const double slack_s = (first.bracket.high - first.bracket.low) * piece_s + wire_contract::kNanosecond_s;
  set_velocity(found, piece.mover_motion.velocity(first.at.on_a, t, piece_s, slack_s),
               piece.fence_motion.velocity(first.at.on_b, t, piece_s, slack_s));
  predict(piece, t, found);
}

/// Predicts when the two would touch if both continued as at time t; stores it in found.surface: seconds from then as
/// depth, with its error.
void BandPredicate::predict(const StandingPiece& piece, double t, FoundContact& found) {
  const double piece_s = piece.seconds();
  const double turn_rad = std::max(piece.mover_motion.turn_rad, piece.fence_motion.turn_rad);
  const std::uint32_t carrier = table_.carrier(piece.fence);
  double ahead_s = turn_rad > 0 ? std::min(kPredicted_s, kPredictedTurn_rad / turn_rad * piece_s) : kPredicted_s;
  // Once an object has passed the other completely they cannot touch; a shorter motion also rounds less.
  const double speed_mps = (piece.fence_motion.travel - piece.mover_motion.travel).norm() / piece_s;
  const double across_m = 2 * (rows_[piece.mover].reach_m + rows_[carrier].reach_m) - found.contact.depth_m;
  const bool is_endless = !rows_.bounds(carrier).low.allFinite() || !rows_.bounds(carrier).high.allFinite();
  if (!is_endless && turn_rad == 0 && across_m < 0.5 * kPredicted_s * speed_mps) ahead_s = 2 * across_m / speed_mps;
  const GapOptions options{.width = kPredictedWidth, .most_looks = kBandLooks.least, .looks = &cost_.sweep_looks};
  const GapTime touch =
      engine::first_within(body_of(piece.mover, goes_on(piece.mover_motion, t, piece_s, ahead_s)),
                           body_of(carrier, goes_on(piece.fence_motion, t, piece_s, ahead_s)), {0, 0}, options, walk_);
  if (!touch.yes) return;
  const double low_s = touch.bracket.low * ahead_s;
  const double high_s = touch.bracket.high * ahead_s;
  found.surface->depth_m = (low_s + high_s) / 2;
  found.surface->depth_error_m = (high_s - low_s) / 2 * (1 + kBoundSlack) + kRoundoff * 4 * high_s;
}

}  // namespace collided::engine
