#include "server/world/fences/region_predicate.hpp"

#include "server/geometry/tolerance.hpp"
#include "server/world/objects/sweep.hpp"
#include "server/world/solids/within.hpp"

namespace collided::engine {
namespace {

/// Tests of pairs of parts.
constexpr LookBudget kRegionLooks{.most = 10'000, .of_step = 50'000, .least = 200};

const Pose kWorldPose;

/// True if the box is axis-aligned and certainly holds the point: a difference and a comparison round too little to
/// matter.
bool surely_holds_point(const Box& box, const Vec3& point) {
  if (box.axes != Mat3::Identity()) return false;
  return ((point - box.center).cwiseAbs().array() * (1 + kFewSlack) < box.half_m.array()).all();
}

/// True if the whole object is one ball or box centred on its frame's origin, so that the origin is a point of it.
bool is_about_origin(const ObjectInfo& info, const std::optional<Sphere>& ball) {
  if (ball) return ball->center.isZero(0);
  const Box* box = lone_box(info);
  return box != nullptr && box->center.isZero(0);
}

/// Testing two of these needs no bounds, and takes no longer than computing bounds.
bool is_ball_or_box(const ObjectInfo& info) { return lone_box(info) != nullptr || lone_sphere(info); }

}  // namespace

bool RegionPredicate::surely_holds(std::uint32_t fence, std::uint32_t mover) {
  if (table_.is_carried(fence) || !is_about_origin(*rows_.info(mover), rows_.lone_sphere(mover))) return false;
  const Box* box = lone_box(table_.body(fence));
  return box != nullptr && surely_holds_point(*box, rows_[mover].pose.position);
}

/// A region in the world was found by the bounds of the whole motion, so they need no second test.
bool RegionPredicate::may_hold(const StandingPiece& piece) {
  return !table_.is_carried(piece.fence) ||
         overlaps(bounds(*rows_.info(piece.mover), piece.mover_motion, rows_[piece.mover].reach_m),
                  bounds(table_.body(piece.fence), piece.fence_motion, table_.reach_m(piece.fence)));
}

/// The two ends of a piece show everything that a single convex object does if it moves straight.
bool RegionPredicate::may_turn_back(const StandingPiece& piece) {
  return !touch_at_most_once(*rows_.info(piece.mover), piece.mover_motion, table_.body(piece.fence),
                             piece.fence_motion);
}

Decision RegionPredicate::at_end(const StandingPiece& piece, bool /*was_in*/) {
  touch_ = touch_surfaces(piece, piece.mover_motion.to, piece.fence_motion.to);
  is_within_ = !touch_.yes && is_within_at(piece, 1);
  if (touch_.yes || is_within_) return Decision::yes;
  return touch_.undecided ? Decision::undecided : Decision::no;
}

ContactSearch RegionPredicate::touch_surfaces(const StandingPiece& piece, const Frame& mover_frame,
                                              const Frame& fence_frame) {
  ContactSearch touch;
  touch.wanted = may_turn_back(piece);
  const bool with_bounds = !is_ball_or_box(*rows_.info(piece.mover)) || !is_ball_or_box(table_.body(piece.fence));
  const Placed mover = placed_at(rows_, piece.mover, mover_frame, with_bounds);
  const Placed fence = placed_fence(piece.fence, fence_frame);
  if (with_bounds && !overlaps(mover.bounds, fence.bounds)) return touch;
  search_objects(mover, fence, touch, walk_);
  cost_.exact_tests += touch.exact_tests;
  return touch;
}

Placed RegionPredicate::placed_fence(std::uint32_t fence, const Frame& frame) {
  const std::uint32_t carrier = table_.carrier(fence);
  const ObjectInfo& body = table_.body(fence);
  Placed placed{.info = &body, .frame = frame, .bounds = {}, .pose = nullptr};
  if (carrier == FenceTable::kNone) placed.pose = &kWorldPose;
  else if (is_same(frame, rows_[carrier].frame())) placed.pose = &rows_[carrier].pose;
  placed.bounds = carrier == FenceTable::kNone ? table_.bounds(fence) : bounds_of(body, frame);
  return placed;
}

/// For two whose surfaces do not touch at that time: true if one contains some of the other.
bool RegionPredicate::is_within_at(const StandingPiece& piece, double t) {
  if (!rows_.info(piece.mover)->rare->solid && !table_.body(piece.fence).rare->solid) return false;
  const Placed mover = placed_at(rows_, piece.mover, piece.mover_motion.at(t));
  const Placed fence = placed_fence(piece.fence, piece.fence_motion.at(t));
  if (!overlaps(mover.bounds, fence.bounds)) return false;
  return holds_some(fence, mover, lists_.mover_points) || holds_some(mover, fence, lists_.fence_points);
}

/// For two whose surfaces do not meet: true if the outer one, a solid mesh, contains some of the inner one.
bool RegionPredicate::holds_some(const Placed& outer, const Placed& inner, PiecePoints& points) {
  if (!outer.info->rare->solid) return false;
  Deadline never;
  return pieces_within(*outer.info->rare->solid, outer, inner, points.of(*inner.info), never, walk_, cost_.exact_tests)
      .some;
}

SweptContact RegionPredicate::first_within(const StandingPiece& piece) {
  if (piece.fence_motion.turn_rad == 0) {
    if (const std::optional<SweptContact> found = sweep_sphere(piece, true)) return *found;
  }
  if (piece.mover_motion.turn_rad == 0) {
    if (const std::optional<SweptContact> found = sweep_sphere(piece, false)) return turned_round(*found);
  }
  return sweep_span(piece, {0, 1});
}

/// first_within() of the reversed motion.
SweptContact RegionPredicate::last_within(const StandingPiece& piece) {
  SweptContact last = first_within(piece.reversed());
  last.bracket = reversed(last.bracket);
  return last;
}

SweptContact RegionPredicate::sweep_span(const StandingPiece& piece, const TimeSpan& span) {
  SweptContact touch;
  const SweepOptions options{.width = bracket_width(piece.from_ns, piece.to_ns),
                             .span = span,
                             .contacts = true,
                             .most_looks = kRegionLooks.after(cost_.sweep_looks),
                             .looks = &cost_.sweep_looks};
  sweep(SweptBody(*rows_.info(piece.mover), piece.mover_motion),
        SweptBody(table_.body(piece.fence), piece.fence_motion), options, walk_, touch);
  cost_.exact_tests += touch.exact_tests;
  return touch;
}

/// The exact sweep of one object's sphere along its motion relative to the other; nothing if it is not a lone sphere.
std::optional<SweptContact> RegionPredicate::sweep_sphere(const StandingPiece& piece, bool is_mover) {
  const std::optional<Sphere> sphere =
      is_mover ? rows_.lone_sphere(piece.mover) : lone_sphere(table_.body(piece.fence));
  if (!sphere) return std::nullopt;
  const BodyMotion& motion = is_mover ? piece.mover_motion : piece.fence_motion;
  const BodyMotion& others = is_mover ? piece.fence_motion : piece.mover_motion;
  // The centre moves straight only if the body does not rotate about another point.
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

bool RegionPredicate::find_times(const StandingPiece& piece, bool was_in, const SweptContact* first) {
  const TouchAtEnd begin = was_in ? surfaces_at_begin(piece) : TouchAtEnd{};
  const TouchAtEnd end{touch_.yes, touch_.a_triangle, touch_.b_triangle, touch_.contact};
  if (!begin.yes && !end.yes && first != nullptr && !first->yes) return false;
  const StandingPiece back = piece.reversed();
  const SweptBody mover(*rows_.info(piece.mover), piece.mover_motion);
  const SweptBody fence(table_.body(piece.fence), piece.fence_motion);
  const auto sweep_from = [&](const TimeSpan& span, bool is_reversed) {
    const StandingPiece& way = is_reversed ? back : piece;
    return span.low == 0 && span.high == 1 ? first_within(way) : sweep_span(way, span);
  };
  const auto test_at = [&](double t) {
    return touch_surfaces(piece, piece.mover_motion.at(t), piece.fence_motion.at(t));
  };
  const BodiesInMotion bodies({mover, rows_[piece.mover].reach_m}, {fence, table_.reach_m(piece.fence)}, sweep_from,
                              test_at);
  if (begin.yes && end.yes && surely_touch_throughout(bodies, begin, end)) return false;
  const ContactTimesLimits limits{.width = bracket_width(piece.from_ns, piece.to_ns),
                                  .most = step_.options.max_intervals};
  find_contact_times(bodies, begin, end, first, limits, lists_.times);
  if (lists_.times.intervals.empty()) return false;
  if (lists_.times.is_open) ++cost_.sweeps_skipped;
  return true;
}

/// For an object inside: whether the surfaces touch when the piece begins. Without a solid mesh they must.
TouchAtEnd RegionPredicate::surfaces_at_begin(const StandingPiece& piece) {
  if (!rows_.info(piece.mover)->rare->solid && !table_.body(piece.fence).rare->solid) return {.yes = true};
  const ContactSearch touch = touch_surfaces(piece, piece.mover_motion.from, piece.fence_motion.from);
  return {touch.yes, touch.a_triangle, touch.b_triangle, touch.contact};
}

bool RegionPredicate::is_in_after(const StandingPiece& piece, std::size_t interval) {
  const std::vector<ContactInterval>& intervals = lists_.times.intervals;
  if (interval + 1 == intervals.size()) return touch_.yes || is_within_;
  return is_within_at(piece, (intervals[interval].end->high + intervals[interval + 1].begin->bracket.low) / 2);
}

}  // namespace collided::engine
