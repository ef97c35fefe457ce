#include "server/exact_phase/motion/swept_convex.hpp"

#include <algorithm>

#include "server/exact_phase/distance/half_space_kernel.hpp"
#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/motion/monotone_bracket.hpp"
#include "server/exact_phase/round_solids/axial_exact.hpp"
#include "server/exact_phase/round_solids/ellipsoid_exact.hpp"

namespace collided::engine::kernel {
namespace {

bool is_flat(const Convex& set) { return set.is_polytope() && set.ball_m == 0; }

/// The lower end of the motion decides: whether the set is ahead of the plane at both ends.
template <class N>
Decision stays_ahead(const HalfSpace& ground, const Convex& set, const StraightMotion& motion) {
  const N rise = dot(Vector<N>(ground.normal), motion.displacement<N>());
  const ReachAlong<N> reach = reach_along<N>(set, ground.normal, -1, ground.point);
  const ReachPart<N> none{N(0.0), N(0.0), N(1.0)};
  const N down = max(N(0.0), -rise);
  AllOf all;
  for (int i = 0; i < reach.count; ++i) {
    if (all.add(root_sum_negative(reach.part[i].rational + down, reach.part[i], none))) return Decision::no;
  }
  return all.result();
}

}  // namespace

ExactResult meet_on_motion(const Convex& a, const Convex& b, const StraightMotion& motion) {
  if (a.is_polytope() && b.is_polytope()) return {polytopes_meet_on_motion(a, b, motion), Level::rational};
  if (!is_flat(b))
    return is_flat(a) ? meet_on_motion(b, a, motion.turned()) : ExactResult{Decision::undecided, Level::rational};
  if (a.plus == Convex::Plus::ellipsoid) return {ellipsoid_meets_flat(a, b, &motion), Level::rational};
  return axial_meets_flat(a, b, &motion);
}

ExactResult first_contact_on_motion(const Convex& a, const Convex& b, const StraightMotion& motion, double guess,
                                    double width, TimeBracket& bracket) {
  StraightMotion part = motion;
  const auto touched_by = [&](double t) {
    part.until = std::min(t, motion.until);
    return meet_on_motion(a, b, part);
  };
  return bracket_monotone(
      touched_by, [&] { return guess; }, width, bracket);
}

ExactResult first_contact_on_motion(const Convex& a, const HalfSpace& ground, const StraightMotion& motion,
                                    double guess, double width, TimeBracket& bracket) {
  StraightMotion part = motion;
  const auto touched_by = [&](double t) {
    part.until = std::min(t, motion.until);
    const ExactResult ahead = climb([&]<class N>() { return stays_ahead<N>(ground, a, part); });
    return ExactResult{opposite(ahead.decision), ahead.level};
  };
  return bracket_monotone(
      touched_by, [&] { return guess; }, width, bracket);
}

}  // namespace collided::engine::kernel
