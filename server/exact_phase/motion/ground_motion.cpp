#include "server/exact_phase/motion/ground_motion.hpp"

#include <algorithm>
#include <variant>

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/motion/monotone_bracket.hpp"
#include "server/exact_phase/motion/swept_convex.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

/// The search for a rotating part's first contact with a plane.
class Landing {
 public:
  Landing(const PartMotion& part, const HalfSpace& ground, double placing_m, double width, TimeBracket& bracket)
      : part_(part),
        ground_(ground),
        plane_(Sphere{ground.point, 0}),
        width_(width),
        bracket_(bracket),
        motion_m_(part.motion->length_m(part.reach_m)),
        error_m_(2 * part.motion->error_m(part.reach_m) + placing_m) {}

  /// Searches a span; `yes` fills the bracket.
  Decision look(const TimeSpan& span) {
    const double length = span.high - span.low;
    const double middle = span.low + length / 2;
    if (clearance_m(middle) > (motion_m_ * (length / 2) + error_m_) * (1 + kBoundSlack)) return Decision::no;
    if (length <= width_ || !(span.low < middle && middle < span.high)) return at_the_end(span);
    const Decision first = look({span.low, middle});
    if (first == Decision::yes) return first;
    const Decision second = look({middle, span.high});
    return second == Decision::no ? first : second;
  }

 private:
  /// A lower bound on the placed part's distance from the plane; negative if it is not certainly ahead of it.
  double clearance_m(double t) const {
    const kernel::Convex set = std::visit([](const auto& shape) { return kernel::Convex(shape); }, part_.at(t));
    return -kernel::push_along(ground_.normal, plane_, set).high();
  }
  Decision at_the_end(const TimeSpan& span) const {
    const ExactResult there =
        std::visit([&](const auto& shape) { return overlaps(ground_, shape); }, part_.at(span.high));
    if (!there.yes()) return Decision::undecided;
    bracket_ = {span.low, span.high};
    return Decision::yes;
  }

  const PartMotion& part_;
  const HalfSpace& ground_;
  kernel::Convex plane_;
  double width_;
  TimeBracket& bracket_;
  double motion_m_;
  double error_m_;
};

/// For a straight motion: exact, from the part's first position and its translation, neither of which is rounded. A
/// part that is ahead of the plane at span.low and was not before has left it for good.
ExactResult straight_to_ground(const PartMotion& part, const HalfSpace& ground, TimeSpan span, double width,
                               TimeBracket& bracket) {
  const BoundedPart first = part.at(0);
  const kernel::Convex start = std::visit([](const auto& shape) { return kernel::Convex(shape); }, first);
  const kernel::StraightMotion motion{
      .from_a = part.motion->from.position, .to_a = part.motion->to.position, .until = span.high};
  const double gap_m = -kernel::reach_value(start, ground.normal, -1, ground.point).value;
  const double down_m = -ground.normal.dot(part.motion->travel);
  TimeBracket exact;
  const ExactResult verdict =
      kernel::first_contact_on_motion(start, ground, motion, down_m > 0 ? gap_m / down_m : 0, width, exact);
  if (verdict.yes() && exact.high < span.low) return {Decision::no, verdict.level};
  if (verdict.yes()) bracket = {std::max(exact.low, span.low), std::max(exact.high, span.low)};
  return verdict;
}

/// placing_m: bound on the placing error of the two together.
ExactResult contact_of_placed(const PartMotion& part, const HalfSpace& ground, double placing_m, TimeSpan span,
                              double width, TimeBracket& bracket) {
  const ExactResult at_once = std::visit([&](const auto& shape) { return overlaps(ground, shape); }, part.at(span.low));
  if (at_once.yes()) {
    bracket = {span.low, span.low};
    return at_once;
  }
  if (part.motion->turn_rad == 0) return straight_to_ground(part, ground, span, width, bracket);
  return {Landing(part, ground, placing_m, width, bracket).look(span), Level::filter};
}

/// True if an answer for the placed two certainly holds if they are off by placing_m: a part that moves straight is
/// lowest at one end of its path.
bool holds_within(const PartMotion& part, const HalfSpace& ground, double placing_m, TimeSpan span,
                  const ExactResult& verdict, const TimeBracket& bracket) {
  const double off_m = placing_m + 2 * part.motion->error_m(part.reach_m);
  const kernel::Convex plane(Sphere{ground.point, 0});
  const auto depth = [&](double t) {
    const BoundedPart placed = part.at(t);
    return kernel::push_along(ground.normal, plane,
                              std::visit([](const auto& shape) { return kernel::Convex(shape); }, placed));
  };
  const auto is_above = [&](double t) { return depth(t).high() < -off_m; };
  if (verdict.decision == Decision::no) return is_above(span.low) && is_above(span.high);
  if (!verdict.yes() || !(depth(bracket.high).low() > off_m)) return false;
  return bracket.high == span.low || (is_above(span.low) && is_above(bracket.low));
}

ExactResult contact_of_given(const PartMotion& part, const HalfSpace& ground, const GivenPart& given, TimeSpan span,
                             double width, TimeBracket& bracket) {
  if (kernel::precision.highest != Level::rational) return {Decision::undecided, Level::filter};
  const PartAsGiven begin(part);
  const ConvexPart plane = Primitive(ground);
  kernel::StraightMotion motion{.from_a = part.motion->from.position, .to_a = part.motion->to.position};
  const double guess = bracket.low;
  return kernel::bracket_monotone(
      [&](double t) {
        motion.until = std::min(t, span.high);
        return ExactResult{overlaps_as_given(begin.placed, plane, {begin.given, given}, motion), Level::rational};
      },
      [&] { return guess; }, width, bracket);
}

}  // namespace

ExactResult first_contact(const PartMotion& part, const HalfSpace& ground, TimeSpan span, double width,
                          TimeBracket& bracket, const GivenPart& given) {
  const double far_m =
      (part.motion->from.position - ground.point).norm() + part.motion->length_m(part.reach_m) + part.reach_m;
  const double placing_m = part.placing_m + given.placing_error_m(far_m);
  const ExactResult placed = contact_of_placed(part, ground, placing_m, span, width, bracket);
  const bool is_placed =
      placing_m == 0 || part.motion->turn_rad != 0 || holds_within(part, ground, placing_m, span, placed, bracket);
  if (is_placed) return placed;
  TimeBracket exact = bracket;
  const ExactResult as_given = contact_of_given(part, ground, given, span, width, exact);
  if (as_given.decision == Decision::undecided && kernel::precision.highest == Level::rational) return placed;
  bracket = exact;
  return as_given;
}

bool surely_stays_above(const BodyMotion& motion, double reach_m, const HalfSpace& ground) {
  const double length = ground.normal.stableNorm();
  const double height_m = ground.normal.dot(motion.at(0.5).position - ground.point) / length;
  const double size_m =
      motion.to.position.lpNorm<1>() + motion.from.position.lpNorm<1>() + ground.point.lpNorm<1>() + reach_m;
  return height_m > reach_m + motion.length_m(reach_m) / 2 + motion.error_m(reach_m) + size_m * kBoundSlack;
}

}  // namespace collided::engine
