#include "server/exact_phase/distance/convex_pair.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/distance/ball_inside.hpp"
#include "server/exact_phase/distance/nearest_value.hpp"
#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/exact_phase/distance/simplex_search.hpp"
#include "server/exact_phase/distance/witnesses.hpp"
#include "server/exact_phase/round_solids/refined_search.hpp"
#include "server/exact_phase/round_solids/round_pair.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

/// The size of the pair, on which the error of support points depends.
double reach_of(const ConvexPair& pair) {
  return (pair.a.carrier[0] - pair.b.carrier[0]).cwiseAbs().sum() + pair.a.reach_m + pair.b.reach_m;
}

/// How far a computed difference point may be from the true difference set.
double support_error_m(const ConvexPair& pair) { return kSupportError * reach_of(pair) * (1 + 16 * kRoundoff); }

double balls_m(const ConvexPair& pair) { return pair.a.ball_m + pair.b.ball_m; }

/// The decision that the proposal alone proves.
Decision quick_decision(const ConvexPair& pair, const Proposal& proposal) {
  if (proposal.parted) return Decision::no;
  const double error_m = support_error_m(pair);
  if (proposal.encloses) return surely_holds_ball(proposal.corner, error_m) ? Decision::yes : Decision::undecided;
  if (proposal.nearest.isZero(0)) return Decision::undecided;
  const double apart_m = proposal.nearest.stableNorm() * (1 + 8 * kRoundoff) + error_m;
  if (apart_m < balls_m(pair) * (1 - 4 * kRoundoff)) return Decision::yes;
  return push_along(Vec3(-proposal.nearest), pair.a, pair.b).high() < 0 ? Decision::no : Decision::undecided;
}

/// The point rounded to multiples of `step`: everyday scenes touch at coordinates of few digits.
Vec3 rounded_off(const Vec3& point, double step) { return ((point / step).array().round() * step).matrix(); }

/// For touching sets that algebra does not decide: tests rounded points that may lie in both.
Decision holds_rounded_point(const ConvexPair& pair, const Witnesses& witnesses) {
  for (const Vec3& point : witnesses.point) {
    constexpr double kEverydaySteps_m[] = {0x1p-24, 1e-9, 1e-6, 0x1p-16, 1e-4, 0x1p-10, 1e-3};
    for (const double step : kEverydaySteps_m) {
      const Vec3 near = rounded_off(point, step);
      if (near.allFinite() && pair.both_hold(near).yes()) return Decision::yes;
    }
  }
  return Decision::undecided;
}

/// By algebra, by everyday coordinates, and last by a search in 256 bits.
Decision decided_by_rationals(const ConvexPair& pair, const Witnesses& witnesses) {
  const Decision by_algebra = round_sets_meet(pair.a, pair.b).decision;
  if (by_algebra != Decision::undecided) return by_algebra;
  const Decision held = holds_rounded_point(pair, witnesses);
  return held != Decision::undecided ? held : refined_meet(ExactSolid(pair.a), ExactSolid(pair.b));
}

/// Near touching: tests each plane and point exactly, then decides by algebra.
ExactResult careful_decision(const ConvexPair& pair, const Proposal& proposal) {
  const DepthProposal depth = depth_proposal(pair.a, pair.b, proposal, 0);
  if (depth.least_m > support_error_m(pair)) return {Decision::yes, Level::filter};
  const Witnesses witnesses(pair.a, pair.b, proposal, depth);
  Level level = Level::filter;
  for (const Vec3& n : witnesses.normal) {
    if (n.isZero(0)) continue;
    const ExactResult parted = climb([&]<class N>() { return parted_along<N>(n, pair.a, pair.b); });
    level = std::max(level, parted.level);
    if (parted.yes()) return {Decision::no, level};
  }
  for (const Vec3& point : witnesses.point) {
    const ExactResult held = pair.both_hold(point);
    level = std::max(level, held.level);
    if (held.yes()) return {Decision::yes, level};
  }
  if (precision.highest != Level::rational) return {Decision::undecided, level};
  ++rungs.rational;
  return {decided_by_rationals(pair, witnesses), Level::rational};
}

/// A contact with the middle of a bracket as its depth.
Contact bracketed(const Vec3& point, const Vec3& normal, double low, double high) {
  const double least = std::max(low, 0.0);
  const double middle = least + std::max(high - least, 0.0) / 2;
  return {point, normal, middle, std::max(high - least, 0.0) / 2 + 2 * kRoundoff * std::abs(high)};
}

}  // namespace

ExactResult sets_overlap(const ConvexPair& pair) {
  // Most pairs are separated by the first plane found, or enclose the origin early; only the others need a complete
  // search.
  const Decision quick = quick_decision(pair, nearest_proposal(pair.a, pair.b, Seek::plane));
  if (quick != Decision::undecided) return {quick, Level::filter};
  const Proposal proposal = nearest_proposal(pair.a, pair.b, Seek::distance);
  const Decision sharp = quick_decision(pair, proposal);
  if (sharp != Decision::undecided) return {sharp, Level::filter};
  ++rungs.uncertain;
  if (precision.highest == Level::filter) return {Decision::undecided, Level::filter};
  if (!pair.a.is_polytope() || !pair.b.is_polytope()) return careful_decision(pair, proposal);
  if (precision.highest != Level::rational) return {Decision::undecided, Level::expansion};
  ++rungs.rational;
  return {polytopes_meet(pair.a, pair.b), Level::rational};
}

Decision sets_overlap_by_rationals(const ConvexPair& pair) {
  if (pair.a.is_polytope() && pair.b.is_polytope()) return polytopes_meet(pair.a, pair.b);
  const Proposal proposal = nearest_proposal(pair.a, pair.b, Seek::distance);
  const Witnesses witnesses(pair.a, pair.b, proposal, depth_proposal(pair.a, pair.b, proposal, 0));
  for (const Vec3& n : witnesses.normal) {
    if (!n.isZero(0) && parted_along<Dyadic>(n, pair.a, pair.b) == Decision::yes) return Decision::no;
  }
  for (const Vec3& point : witnesses.point) {
    if (pair.both_hold(point).yes()) return Decision::yes;
  }
  return decided_by_rationals(pair, witnesses);
}

Contact contact_of(const ConvexPair& pair) {
  const Proposal proposal = nearest_proposal(pair.a, pair.b, Seek::distance);
  const double error_m = support_error_m(pair);
  const double apart_m = proposal.nearest.stableNorm();
  if (!proposal.encloses && apart_m > error_m && balls_m(pair) > 0) {
    const Vec3 normal = unit(Vec3(-proposal.nearest));
    const Vec3 on_a = pair.a.carrier[0] + proposal.on_a();
    const double low = balls_m(pair) * (1 - 2 * kRoundoff) - (apart_m * (1 + 8 * kRoundoff) + error_m);
    const double high = push_along(normal, pair.a, pair.b).high();
    const Contact contact = bracketed(on_a, normal, low, high);
    return {on_a + (pair.a.ball_m - contact.depth_m / 2) * normal, normal, contact.depth_m, contact.depth_error_m};
  }
  const double tolerance_m = std::max(kRefineRay * (pair.a.reach_m + pair.b.reach_m), precision.error_asked_m);
  const DepthProposal depth = depth_proposal(pair.a, pair.b, proposal, tolerance_m);
  const Vec3 middle = (pair.a.carrier[0] + depth.on_a) / 2 + (pair.b.carrier[0] + depth.on_b) / 2;
  const double low = depth.least_m - error_m + balls_m(pair) * (1 - 2 * kRoundoff);
  return bracketed(middle, depth.normal, low, push_along(depth.normal, pair.a, pair.b).high());
}

Separation separation_of(const ConvexPair& pair) {
  const Proposal proposal = nearest_proposal(pair.a, pair.b, Seek::distance);
  Separation result;
  result.normal = unit(Vec3(-proposal.nearest));
  result.point_error_m = support_error_m(pair) + 8 * kRoundoff *
                                                     (pair.a.carrier[0].cwiseAbs().maxCoeff() +
                                                      pair.b.carrier[0].cwiseAbs().maxCoeff() + balls_m(pair));
  result.on_a = pair.a.carrier[0] + proposal.on_a() + pair.a.ball_m * result.normal;
  result.on_b = pair.b.carrier[0] + proposal.on_b() - pair.b.ball_m * result.normal;
  const double high =
      proposal.nearest.stableNorm() * (1 + 8 * kRoundoff) + support_error_m(pair) - balls_m(pair) * (1 - 2 * kRoundoff);
  const double low = result.normal.isZero(0) ? 0 : std::max(-push_along(result.normal, pair.a, pair.b).high(), 0.0);
  result.distance_m = low + std::max(high - low, 0.0) / 2;
  result.error_m = std::max(high - low, 0.0) / 2 + 2 * kRoundoff * std::abs(high);
  // Half of the least double is nothing.
  result.error_m = std::max({result.error_m, high - result.distance_m, result.distance_m - low});
  return result;
}

}  // namespace collided::engine::kernel
