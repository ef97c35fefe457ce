#include "server/exact_phase/motion/part_motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/simplex_search.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/given/margin.hpp"
#include "server/exact_phase/motion/monotone_bracket.hpp"
#include "server/exact_phase/motion/moving_features.hpp"
#include "server/exact_phase/motion/moving_solids.hpp"
#include "server/exact_phase/motion/swept_convex.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

using kernel::Convex;

/// Limit of planes along one motion; beyond it the parts slide along each other too closely to be separated. Their
/// number grows with the root of speed^2 / gap: of 200,000 random sweeps five pass at a thousandth of their size and
/// take 520 to 740, and a block that rotates by 3 rad a millionth of its size above another takes 1,000.
constexpr int kMostSteps = 1 << 12;
/// Further planes if a contact was found farther behind them than the requested width: parts that pass each other at a
/// small angle approach far more slowly than the bound on their speed.
constexpr int kMostNarrowing = 1 << 14;
/// Cost, in tests, of an overlap that doubles do not decide, and of a graze.
constexpr std::uint32_t kExactLooks = 8;

/// Shortens lengths and times that must not be exceeded, by far more than their few roundings.
constexpr double kShy = 1 - 0x1p-40;

constexpr double kForever = std::numeric_limits<double>::infinity();

Convex convex_of(const BoundedPart& part) {
  return std::visit([](const auto& shape) { return Convex(shape); }, part);
}

ExactResult overlap_at(const PartMotion& a, const PartMotion& b, double t) {
  return std::visit([](const auto& x, const auto& y) { return overlaps(x, y); }, a.at(t), b.at(t));
}

bool turn(const PartMotion& a, const PartMotion& b) { return a.motion->turn_rad != 0 || b.motion->turn_rad != 0; }

/// True if the answer is about the exactly placed parts, which differ from the placed ones.
bool are_given(const PartMotion& a, const PartMotion& b) { return a.placing_m + b.placing_m > 0; }

/// Whether the two, placed exactly, share a point until t while both move straight.
class GivenMotions {
 public:
  GivenMotions(const PartMotion& a, const PartMotion& b)
      : a_(a),
        b_(b),
        motion_{a.motion->from.position, a.motion->to.position, b.motion->from.position, b.motion->to.position, 0} {}

  ExactResult touch_until(double t) {
    motion_.until = t;
    return {overlaps_as_given(a_.placed, b_.placed, {a_.given, b_.given}, motion_), Level::rational};
  }

 private:
  PartAsGiven a_;
  PartAsGiven b_;
  kernel::StraightMotion motion_;
};

/// The part of a shape that rotation moves: nothing of a wheel around its own axis, nor of a ball around its centre.
struct Lever {
  double points_m = 0;  // largest distance of any point, except of discs and ball, from the axis of the rotation
  double disc_m = 0;    // radius of the discs
  double tilt_m = 0;    // disc_m times the distance of the discs' unit normal from the axis of the rotation

  explicit Lever(const PartMotion& part) {
    if (part.motion->turn_rad == 0) return;
    const Convex set = convex_of(part.own);
    const auto from_axis = [&](const Vec3& own) {
      return part.motion->axis.cross(part.motion->from.rotation * own).norm() + kChainSlack * own.norm();
    };
    if (set.hull != nullptr) {
      points_m = part.reach_m;
      return;
    }
    for (int i = 0; i < set.count(); ++i) points_m = std::max(points_m, from_axis(set.point(i) - part.motion->pivot));
    if (set.plus != Convex::Plus::nothing) {
      for (int i = 0; i < 3; ++i) points_m += set.half_m[i] * from_axis(set.axes.col(i));
      points_m = std::min(points_m * (1 + kBoundSlack), part.reach_m);
    }
    disc_m = set.disc_m;
    if (disc_m > 0) tilt_m = disc_m * from_axis(set.disc_unit);
  }
};

/// Two moving parts, and how long planes between them stay valid.
class Advance {
 public:
  Advance(const PartMotion& a, const PartMotion& b)
      : a_(a),
        b_(b),
        lever_a_(a),
        lever_b_(b),
        slack_m_(2 * (a.motion->error_m(a.reach_m) + b.motion->error_m(b.reach_m)) + a.placing_m + b.placing_m) {}

  /// Finds a plane that separates the two at time t, and a lower bound on the gap; not positive if none was found.
  /// `normal` holds the previous step's plane, which is tried first: for round parts that nearly touch, double finds a
  /// worse one than it did from farther away.
  ///
  /// by_faces  also tries the planes of faces if the nearest points give none
  double part_at(double t, Vec3& normal, bool by_faces) const {
    const BoundedPart a = a_.at(t);
    const BoundedPart b = b_.at(t);
    const Convex set_a = convex_of(a);
    const Convex set_b = convex_of(b);
    const kernel::Proposal proposal = kernel::nearest_proposal(set_a, set_b, kernel::Seek::distance);
    const double gap_before_m = normal.isZero(0) ? 0 : gap_of(normal, set_a, set_b);
    double gap_m = gap_before_m;
    const auto try_plane = [&](const Vec3& n) {
      const double gap_here_m = gap_of(n, set_a, set_b);
      if (!(gap_here_m > 0) || gap_here_m < gap_m) return;
      gap_m = gap_here_m;
      normal = n;
    };
    if (!proposal.encloses && !proposal.nearest.isZero(0)) try_plane(-proposal.nearest.stableNormalized());
    // Nearest points closer than their error give no direction; faces have one.
    if (!(gap_m > 0) && by_faces && !proposal.encloses)
      try_plane(kernel::depth_proposal(set_a, set_b, proposal, 0).normal);
    return gap_m;
  }

  /// Whether the two touch at t: as placed, or certainly if placed exactly.
  ExactResult touch_at(double t) const {
    if (!are_given(a_, b_)) return overlap_at(a_, b_, t);
    const bool surely = surely_meet(a_.placed_at(t), b_.placed_at(t), slack_m_);
    return {surely ? Decision::yes : Decision::undecided, Level::filter};
  }

  /// True if both move straight, and along n they approach by no more than their placing error, or the motion is over:
  /// then their places at its end do not show whether the motion brings them together.
  bool ends_in_doubt(const Vec3& n, double gap_m, double length, bool is_over) const {
    if (turn(a_, b_) || are_given(a_, b_)) return false;
    return is_over || closing_speed_m(n) * length - gap_m <= 4 * slack_m_;
  }

  /// How long the plane across n certainly separates them, given that they are `gap_m` apart along it at t; infinite:
  /// until `end`.
  double parted_for(const Vec3& n, double gap_m, double t, double end) const {
    const double most = end - t;
    const double speed = closing_speed_m(n);
    const double sure = speed > 0 ? gap_m / speed * kShy : kForever;
    if (!(sure < most)) return sure;
    const double bend_m = bend(n);
    if (bend_m == 0) return sure;
    // A bolder step: the plane is tested at its end, and between the ends nothing bends by more than bend step^2.
    double step = std::min(most, std::sqrt(gap_m / (2 * bend_m)));
    for (int attempt = 0; attempt < 3 && step > sure; ++attempt) {
      const double gap_then_m = gap_at(n, t + step);
      if (std::min(gap_m, gap_then_m) * kShy > bend_m * step * step) return step < most ? step : kForever;
      // Shrinks to where the line between the two gaps leaves just enough for the bend.
      const double whole = gap_m > gap_then_m ? step * gap_m / (gap_m - gap_then_m) : step;
      constexpr double kLeastLeft = 0x1p-10;
      const double left = std::clamp(4 * bend_m * whole * whole / gap_m, kLeastLeft, 0.5);
      step = std::min(step * 0.75, whole * (1 - left));
    }
    return sure;
  }

 private:
  double gap_of(const Vec3& n, const Convex& a, const Convex& b) const {
    const double gap_m = -kernel::push_along(n, a, b).high() - slack_m_;
    // Without a least gap, steps would shrink for ever. NaN counts as none.
    return gap_m > slack_m_ / 16 ? gap_m : 0;
  }
  double gap_at(const Vec3& n, double t) const {
    const BoundedPart a = a_.at(t);
    const BoundedPart b = b_.at(t);
    return gap_of(n, convex_of(a), convex_of(b));
  }
  /// An upper bound on how fast the two approach along n, metres per duration of the motion.
  double closing_speed_m(const Vec3& n) const {
    const Vec3 travel = a_.motion->travel - b_.motion->travel;
    const double straight = n.dot(travel) + kChainSlack * travel.cwiseAbs().sum();
    return straight + (turn_of(n, a_, lever_a_) + turn_of(n, b_, lever_b_)) * (1 + kBoundSlack);
  }
  /// Upper bound on how fast the rotation changes the part's reach along n. A disc of radius r and unit normal c
  /// reaches r |n x c|, which is convex in n and in c and nowhere steeper than r in either, and c moves no faster than
  /// its tilt.
  static double turn_of(const Vec3& n, const PartMotion& part, const Lever& lever) {
    const double across = n.cross(part.motion->axis).norm();
    return part.motion->turn_rad * (across * lever.points_m + std::min(across * lever.disc_m, lever.tilt_m));
  }
  /// A set's reach along n changes, within a step, by at most a linear term plus this times the step squared: seen from
  /// the body n rotates, its second derivative is at most turn |n x axis| (that of a disc's normal, seen from the
  /// world, is turn times its tilt), reach is convex in n and nowhere steeper than the lever, and a curve leaves its
  /// chord by at most an eighth of that.
  double bend(const Vec3& n) const {
    const double a = turn_of(n, a_, lever_a_) * a_.motion->turn_rad;
    const double b = turn_of(n, b_, lever_b_) * b_.motion->turn_rad;
    return (a + b) / 8 * (1 + kBoundSlack);
  }

  const PartMotion& a_;
  const PartMotion& b_;
  Lever lever_a_;
  Lever lever_b_;
  double slack_m_;
};

/// If planes fail and the two do not overlap yet: looks for an overlap at growing distances in time, then halves the
/// time between the last test without and the first with one.
ExactResult look_for_overlap(const PartMotion& a, const PartMotion& b, double low, double end, double width,
                             TimeBracket& bracket) {
  ExactResult verdict{Decision::no, Level::filter};
  bracket = {low, low};
  double before = low;
  for (double ahead = 0.46875 * width; before < end; ahead *= 2) {
    double then = std::min(low + ahead, end);
    verdict = overlap_at(a, b, then);
    if (!verdict.yes()) {
      before = then;
      continue;
    }
    while (then - before > width / 2) {
      const double middle = before + (then - before) / 2;
      if (!(middle > before && middle < then)) break;
      (overlap_at(a, b, middle).yes() ? then : before) = middle;
    }
    bracket.high = then;
    return verdict;
  }
  return {Decision::undecided, verdict.level};
}

/// Triangles have no interior: two that cross flat share a point for one instant, which only the pose at that instant
/// shows. They are followed in a piece so short that their corners move straight to within the motion's own error.
/// Nothing if their numbers are out of range, or the test is undecided.
std::optional<Decision> meet_in_piece(const PartMotion& a, const PartMotion& b, double low, double then, double width,
                                      TimeBracket& bracket) {
  const auto moving = [&](const PartMotion& part) {
    const Triangle start = std::get<Triangle>(part.at(low));
    const Triangle end = std::get<Triangle>(part.at(then));
    return MovingTriangle{{start.a, end.a}, {start.b, end.b}, {start.c, end.c}};
  };
  TimeBracket piece;
  const ExactResult verdict = first_contact(moving(a), moving(b), std::min(1.0, width / (then - low)), piece);
  if (verdict.decision == Decision::undecided) return std::nullopt;
  bracket = {low, low};
  if (piece.high == 0) return verdict.decision;
  bracket = {std::max(low, std::nextafter(low + piece.low * (then - low), 0.0)),
             std::min(then, std::nextafter(low + piece.high * (then - low), 2.0))};
  return verdict.decision;
}

/// How long the corners of a triangle move straight to within the motion's error.
double straight_for(const PartMotion& part) {
  const double turn_rad = part.motion->turn_rad;
  if (turn_rad == 0) return kForever;
  return std::sqrt(8 * part.motion->error_m(part.reach_m) / part.reach_m) / turn_rad;
}

/// The exact answer for a box or capsule moving past a resting triangle; nothing for other pairs.
std::optional<ExactResult> past_triangle(const PartMotion& a, const PartMotion& b, double width, TimeBracket& bracket) {
  if (std::holds_alternative<Triangle>(a.own)) {
    return std::holds_alternative<Triangle>(b.own) ? std::nullopt : past_triangle(b, a, width, bracket);
  }
  const Triangle* other = std::get_if<Triangle>(&b.own);
  if (other == nullptr || !b.motion->travel.isZero(0)) return std::nullopt;
  const Triangle resting = place(b.motion->from, *other);
  const Vec3& from = a.motion->from.position;
  const Vec3& to = a.motion->to.position;
  if (const Box* box = std::get_if<Box>(&a.own)) {
    return first_contact(Translated<Box>{place(a.motion->from, *box), from, to}, resting, width, bracket);
  }
  if (const Capsule* capsule = std::get_if<Capsule>(&a.own)) {
    return first_contact(Translated<Capsule>{place(a.motion->from, *capsule), from, to}, resting, width, bracket);
  }
  return std::nullopt;
}

/// The exact answer over the whole motion of two parts that do not rotate; nothing if there is none. `low`: no contact
/// before it.
std::optional<ExactResult> exactly(const PartMotion& a, const PartMotion& b, double low, double width,
                                   TimeBracket& bracket) {
  if (turn(a, b) || kernel::precision.highest != Level::rational) return std::nullopt;
  if (are_given(a, b)) {
    GivenMotions given(a, b);
    const ExactResult verdict =
        kernel::bracket_monotone([&](double t) { return given.touch_until(t); }, [&] { return low; }, width, bracket);
    if (verdict.decision != Decision::undecided) return verdict;
  }
  if (const std::optional<ExactResult> verdict = past_triangle(a, b, width, bracket)) return verdict;
  const BoundedPart start_a = a.at(0);
  const BoundedPart start_b = b.at(0);
  const kernel::StraightMotion motion{a.motion->from.position, a.motion->to.position, b.motion->from.position,
                                      b.motion->to.position};
  const ExactResult verdict =
      kernel::first_contact_on_motion(convex_of(start_a), convex_of(start_b), motion, low, width, bracket);
  if (verdict.decision == Decision::undecided) return std::nullopt;
  return verdict;
}

/// Decides if the separating planes found so far prove nothing more: the parts touch, or are closer than planes can
/// show.
ExactResult decide_graze(const Advance& advance, const PartMotion& a, const PartMotion& b, double low, TimeSpan span,
                         double width, TimeBracket& bracket) {
  const double end = span.high;
  const bool has_rationals = kernel::precision.highest == Level::rational;
  const auto at_once = [&] {
    bracket = {low, low};
    const ExactResult placed = advance.touch_at(low);
    if (placed.yes() || !are_given(a, b) || !has_rationals) return placed;
    const ExactResult given = low == 0 ? GivenMotions(a, b).touch_until(0) : placed;
    return given.decision != Decision::undecided ? given : overlap_at(a, b, low);
  };
  // The start of the motion is not rounded: a part that rests on another needs no test of its motion.
  if (low == 0) {
    const ExactResult verdict = at_once();
    if (verdict.yes()) return verdict;
  }
  if (are_given(a, b) && !has_rationals) return {Decision::undecided, Level::filter};
  TimeBracket exact;
  if (const std::optional<ExactResult> verdict = exactly(a, b, low, width, exact)) {
    // Two that move straight and met before the span touch at its beginning, or have separated for good.
    if (verdict->yes() && exact.high < span.low) return at_once();
    const bool is_before = verdict->yes() && exact.low <= end;
    // A contact before `low` comes from rounding the ends.
    if (is_before) bracket = {std::max(exact.low, low), std::max(exact.high, low)};
    return {is_before ? Decision::yes : Decision::no, verdict->level};
  }
  const ExactResult verdict = at_once();
  return verdict.yes() ? verdict : look_for_overlap(a, b, low, end, width, bracket);
}

/// Raises the lower end of a bracket by further planes, and lowers its upper end by overlaps found on the way, until it
/// is narrow enough or no plane is found.
void narrow(const Advance& advance, double width, TimeBracket& bracket) {
  Vec3 normal = Vec3::Zero();
  for (int step = 0; step < kMostNarrowing && bracket.high - bracket.low > width; ++step) {
    const double gap_m = advance.part_at(bracket.low, normal, true);
    if (!(gap_m > 0)) return;
    const double ahead = advance.parted_for(normal, gap_m, bracket.low, bracket.high);
    const double low = bracket.low + ahead * kShy;
    if (!(low > bracket.low && low < bracket.high)) return;
    bracket.low = low;
    const double then = low + width * 0.9375;
    if (then < bracket.high && advance.touch_at(then).yes()) bracket.high = then;
  }
}

}  // namespace

BoundedPart part_of(const Primitive& primitive) {
  return std::visit(
      [](const auto& shape) -> BoundedPart {
        if constexpr (std::is_same_v<decltype(shape), const HalfSpace&>) {
          assert(false);
          return Sphere{shape.point, 0};
        } else {
          return shape;
        }
      },
      primitive);
}

PartMotion::PartMotion(BoundedPart part, const BodyMotion& on) : own(std::move(part)), motion(&on) {
  const Convex set = convex_of(own);
  reach_m = on.lever_m((set.carrier[0].stableNorm() + set.reach_m + set.ball_m) * (1 + kBoundSlack));
  placing_m = std::visit([&](const auto& shape) { return on.placing_m(shape); }, own);
}

BoundedPart PartMotion::at(double t) const {
  const Frame frame = motion->at(t);
  return std::visit([&](const auto& shape) { return BoundedPart(place(frame, shape)); }, own);
}

ConvexPart PartMotion::placed_at(double t) const {
  const Frame frame = motion->at(t);
  return std::visit([&](const auto& shape) { return as_part(place(frame, shape)); }, own);
}

PartAsGiven::PartAsGiven(const PartMotion& part)
    : placed(part.placed_at(0)), own(std::visit([](const auto& shape) { return as_part(shape); }, part.own)) {
  if (part.motion->given == nullptr) return;
  if (const auto* triangle = std::get_if<Triangle>(&own)) given.own = *triangle;
  else given.own = &std::get<Primitive>(own);
  given.pose = part.motion->given;
  given.frame = &part.motion->from;
}

ExactResult first_contact(const PartMotion& a, const PartMotion& b, TimeSpan span, double width, TimeBracket& bracket,
                          std::uint32_t* looks) {
  const Advance advance(a, b);
  const bool are_flat = std::holds_alternative<Triangle>(a.own) && std::holds_alternative<Triangle>(b.own) &&
                        (turn(a, b) || !are_given(a, b));
  const bool do_turn = turn(a, b);
  double low = span.low;
  Vec3 normal = Vec3::Zero();
  for (int step = 0; step < kMostSteps; ++step) {
    if (looks != nullptr) ++*looks;
    // Most straight motions are decided exactly instead.
    const double gap_m = advance.part_at(low, normal, do_turn);
    if (!(gap_m > 0)) {
      const double then = std::min({span.high, low + straight_for(a), low + straight_for(b)});
      if (!are_flat || !(then > low)) break;
      const std::optional<Decision> met = meet_in_piece(a, b, low, then, width, bracket);
      if (!met) break;
      if (*met == Decision::yes || then == span.high) return {*met, Level::rational};
      low = then;
      normal.setZero();
      continue;
    }
    const double ahead = advance.parted_for(normal, gap_m, low, span.high);
    if (ahead == kForever || low + ahead >= span.high) return {Decision::no, Level::filter};
    const double before = low;
    // Stays short of it: at the contact itself no plane would be certain any more.
    low += ahead > width ? ahead - width / 4 : ahead * kShy;
    const double then = std::min(low + width * 0.9375, span.high);
    const ExactResult verdict = advance.touch_at(then);
    if (looks != nullptr && verdict.level != Level::filter) *looks += kExactLooks;
    if (!verdict.yes()) continue;
    if (advance.ends_in_doubt(normal, gap_m, span.high - before, then == 1)) break;
    bracket = {low, then};
    return verdict;
  }
  if (looks != nullptr) *looks += kExactLooks;
  const ExactResult verdict = decide_graze(advance, a, b, low, span, width, bracket);
  if (verdict.yes() && bracket.high - bracket.low > width) narrow(advance, width, bracket);
  return verdict;
}

Contact contact_at(const PartMotion& a, const PartMotion& b, double t) {
  return std::visit(
      [](const auto& x, const auto& y) {
        if constexpr (requires { contact(x, y); }) {
          return contact(x, y);
        } else {
          Contact turned = contact(y, x);
          turned.normal = -turned.normal;
          return turned;
        }
      },
      a.at(t), b.at(t));
}

}  // namespace collided::engine
