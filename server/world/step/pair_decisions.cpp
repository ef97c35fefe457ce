// Pairs of objects at the step's end: their contact there, and the first one during the step.

#include <algorithm>
#include <utility>

#include "idl/clocks.hpp"
#include "server/exact_phase/motion/ball_motion_filter.hpp"
#include "server/exact_phase/motion/box_motion_filter.hpp"
#include "server/geometry/guess_tolerance.hpp"
#include "server/world/step/decisions.hpp"

namespace collided::engine {
namespace {

/// False: they are not two boxes, or search_objects() must decide them.
bool search_placed(const PlacedBoxPair& boxes, ContactSearch& touch) {
  if (!boxes.are_boxes()) return false;
  return search_boxes(boxes.a->motion.at_end, boxes.b->motion.at_end, placing_error_m(*boxes.a, *boxes.b), touch);
}

}  // namespace

void Decisions::decide_pair(std::uint32_t first, std::uint32_t second) {
  ++cost_.candidate_pairs;
  // Lower id first: the contact's normal points from a to b.
  if (rows_.info(second)->id < rows_.info(first)->id) std::swap(first, second);
  const bool are_meshes = is_bare_mesh(first) && is_bare_mesh(second);
  if (are_meshes && apart_.holds(first, second)) {
    ++cost_.kept_apart;
    return;
  }
  const ObjectId a = rows_.id(first);
  const ObjectId b = rows_.id(second);
  const bool is_held = ledger_.holds(a, b);
  // Pairs that touched in the last step mostly do so in this one.
  const PlacedBoxPair boxes = lists_.boxes.pair(rows_, first, second);
  if (!is_held && boxes.are_boxes() && boxes_stay_apart(first, second, boxes)) {
    ++cost_.exact_tests;
    return;
  }
  ContactSearch touch;
  touch.wanted = step_.step_options.contacts;
  const bool are_near =
      are_balls_or_boxes(first, second) || overlaps(motion_.pose_bounds(first), motion_.pose_bounds(second));
  WithinSolid within;
  // Nothing lies within a box, unlike in the solid of a mesh.
  if (!boxes.are_boxes() || (are_near && !search_placed(boxes, touch)))
    within = search_placing(first, second, are_near, touch);
  cost_.exact_tests += touch.exact_tests;
  std::optional<SweptContact> sweep;
  std::uint32_t mover = first;
  // For a pair that touches at the end the contact there is reported, and only the time of the first one during the
  // step.
  if (!is_held) sweep = sweep_between(first, second, !touch.yes || may_be_cut(first, second), mover);
  const bool is_passing = sweep && sweep->yes && !touch.yes;
  if ((is_held || touch.yes || is_passing) && (may_be_cut(first, second) || !touch.yes) &&
      !(touch.undecided && !touch.yes)) {
    if (const std::optional<PairPiece> piece = piece_of_step(first, second)) {
      if (decide_intervals(*piece, touch, within, is_held || !sweep ? nullptr : &*sweep)) return;
      if (!touch.yes) {
        const ContactEnd end = parting(*piece);
        if (is_held) return ledger_.parts(a, b, end.reason, end.bracket_low_s, end.bracket_high_s);
        return report(a, b, touch, &*sweep, rows_.has_moved(mover) ? mover : first + second - mover, within.contained,
                      &end);
      }
    }
  }
  report(a, b, touch, sweep ? &*sweep : nullptr, rows_.has_moved(mover) ? mover : first + second - mover,
         within.contained);
  // An object in a solid has a gap too, but is in contact.
  if (are_meshes && !touch.yes && touch.exact_tests == 0 && are_near) look_for_gap(first, second);
}

std::uint32_t Decisions::sweep_looks() const {
  const std::uint32_t left = kStepLooks - std::min(kStepLooks, cost_.sweep_looks);
  return std::clamp(left, kLeastSweepLooks, kMostSweepLooks);
}

SweepOptions Decisions::sweep_options(std::uint32_t mover) const {
  const double motion_s =
      static_cast<double>(rows_[mover].posed_ns - rows_[mover].posed_before_ns) * wire_contract::kNanosecond_s;
  return {.width = std::clamp(step_.options.sweep_width_s / motion_s, kNarrowestBracket, kWidestBracket),
          .contacts = step_.step_options.contacts,
          .most_looks = sweep_looks(),
          .looks = &cost_.sweep_looks};
}

/// Uses the same relative motion as sweep_between(), which is exact for the remaining pairs.
bool Decisions::stay_apart(std::uint32_t first, std::uint32_t second) const {
  if (motion_.ball(first).radius_m < 0 || motion_.ball(second).radius_m < 0) return false;
  if (rows_.has_lower_id(second, first)) std::swap(first, second);
  const BallMotion& a = motion_.ball(first);
  const BallMotion& b = motion_.ball(second);
  MovingSphere path{.start = a.end, .end = a.end, .radius_m = a.radius_m};
  if (rows_.motion(first) != Motion::placed && rows_.motion(second) != Motion::placed) {
    if (rows_.motion(first) == Motion::moved) path.start = a.start;
    if (rows_.motion(second) == Motion::moved) path.start += b.end - b.start;
  }
  return kernel::surely_apart(path, {.center = b.end, .radius_m = b.radius_m});
}

/// Searches two objects of any kind where they are at the end of the step.
WithinSolid Decisions::search_placing(std::uint32_t first, std::uint32_t second, bool are_near, ContactSearch& touch) {
  if (!are_near && !rows_.info(first)->rare->solid && !rows_.info(second)->rare->solid) return {};
  const bool with_bounds = !are_balls_or_boxes(first, second);
  const Placed a = placed(first, with_bounds);
  const Placed b = placed(second, with_bounds);
  if (are_near) search_objects(a, b, touch, walk_);
  if (touch.yes) return {};
  const Contained contained = look_within(a, b, touch);
  return {touch.yes, contained};
}

/// True unless the two are single convex objects that move straight.
bool Decisions::may_be_cut(std::uint32_t first, std::uint32_t second) const {
  return motion_.turns(first) || motion_.turns(second) || !is_lone_convex(*rows_.info(first)) ||
         !is_lone_convex(*rows_.info(second));
}

/// The motions of both in this step, lower id first; nothing if one of them was placed or no time is known.
std::optional<PairPiece> Decisions::piece_of_step(std::uint32_t first, std::uint32_t second) const {
  if (rows_.motion(first) == Motion::placed || rows_.motion(second) == Motion::placed) return std::nullopt;
  const std::uint32_t mover = rows_.motion(first) == Motion::moved ? first : second;
  const ObjectRow& row = rows_[mover];
  if (rows_.motion(mover) != Motion::moved || row.posed_before_ns == kPosedAtStep ||
      row.posed_before_ns >= row.posed_ns)
    return std::nullopt;
  return PairPiece{.a = first,
                   .b = second,
                   .from_ns = row.posed_before_ns,
                   .to_ns = row.posed_ns,
                   .a_motion = motion_.body_motion(first),
                   .b_motion = motion_.body_motion(second),
                   .is_of_step = true,
                   .is_timed = is_timed(mover)};
}

/// True if the two certainly do not meet during their motions.
bool Decisions::boxes_stay_apart(std::uint32_t first, std::uint32_t second, const PlacedBoxPair& boxes) const {
  const bool is_placed = rows_.motion(first) == Motion::placed || rows_.motion(second) == Motion::placed;
  if (!is_placed) return kernel::surely_apart(boxes.a->motion, boxes.b->motion);
  // A mover on its way does not meet an object that was placed there later: both count as resting.
  const auto resting = [&](std::uint32_t slot) {
    const ObjectRow& row = rows_[slot];
    const Frame frame = row.frame();
    return kernel::MovingBox(*lone_box(*rows_.info(slot)), frame, frame, row.reach_m);
  };
  return kernel::surely_apart(resting(first), resting(second));
}

/// The first contact of the two motions. A lone sphere is swept exactly against anything that does not rotate; `mover`
/// becomes the object whose motion the time refers to.
std::optional<SweptContact> Decisions::sweep_between(std::uint32_t first, std::uint32_t second, bool with_contact,
                                                     std::uint32_t& mover) {
  if (rows_.motion(first) == Motion::placed || rows_.motion(second) == Motion::placed) return std::nullopt;
  if (!motion_.turns(first) && !motion_.turns(second)) {
    if (std::optional<SweptContact> found = sweep_sphere(first, second, with_contact)) return found;
    mover = second;
    if (const std::optional<SweptContact> found = sweep_sphere(second, first, with_contact))
      return turned_round(*found);
  }
  mover = motion_.is_swept(first) ? first : second;
  if (!motion_.is_swept(mover)) return std::nullopt;
  return sweep_bodies(first, second, with_contact);
}

SweptContact Decisions::sweep_bodies(std::uint32_t first, std::uint32_t second, bool with_contact) {
  SweptContact touch;
  const SweptBody a(*rows_.info(first), motion_.body_motion(first));
  const SweptBody b(*rows_.info(second), motion_.body_motion(second));
  SweepOptions options = sweep_options(motion_.is_swept(first) ? first : second);
  options.contacts = options.contacts && with_contact;
  sweep(a, b, options, walk_, touch);
  return touch;
}

/// Sweeps the mover's sphere relative to the other object in its last orientation: the other's displacement is
/// subtracted.
std::optional<SweptContact> Decisions::sweep_sphere(std::uint32_t mover, std::uint32_t other, bool with_contact) {
  const std::optional<Sphere> sphere = rows_.lone_sphere(mover);
  if (!sphere) return std::nullopt;
  const bool other_moved = rows_.motion(other) == Motion::moved;
  const ObjectRow& row = rows_[mover];
  const Pose& before = rows_.motion(mover) == Motion::moved ? row.pose_before : row.pose;
  SphereSweep sweep{.mover = {.start = placed_center(before, sphere->center),
                              .end = placed_center(row.pose, sphere->center),
                              .radius_m = sphere->radius_m},
                    .width = step_.options.sweep_width,
                    .contacts = with_contact};
  if (other_moved) sweep.mover.start += rows_[other].pose.position - rows_[other].pose_before.position;
  sweep_object(sweep, placed(other, false), walk_);
  return sweep.found;
}

}  // namespace collided::engine
