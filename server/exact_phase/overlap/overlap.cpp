#include "server/exact_phase/overlap/overlap.hpp"

#include <cmath>
#include <variant>

#include "server/exact_phase/distance/general_shapes.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/distance/nearest_filter.hpp"
#include "server/exact_phase/kernels/overlap_kernel.hpp"
#include "server/exact_phase/overlap/ball_filter.hpp"
#include "server/exact_phase/overlap/capsule_filter.hpp"
#include "server/exact_phase/overlap/separation_filter.hpp"

namespace collided::engine {
using kernel::climb;
using kernel::quickly_overlaps;
using kernel::sets_meet;

namespace {

/// Squared radii that neither underflow nor overflow.
bool in_filter_range(double radius2) { return radius2 >= kFilterLowest2 && radius2 <= 1 / kFilterLowest2; }

}  // namespace

ExactResult overlaps(const Sphere& a, const Sphere& b) {
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

ExactResult overlaps(const Sphere& a, const Box& b) {
  const Decision quick = quickly_overlaps(a, b);
  if (quick != Decision::undecided) return {quick, Level::filter};
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

ExactResult overlaps(const Sphere& a, const Capsule& b) {
  const Decision quick = quickly_overlaps(a, b);
  if (quick != Decision::undecided) return {quick, Level::filter};
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

ExactResult overlaps(const Sphere& a, const Triangle& b) {
  // Most triangles that a sphere meets have a corner in it.
  const double radius2 = a.radius_m * a.radius_m;
  if (in_filter_range(radius2) && kernel::quick_nearest_corner2(a.center, b) < radius2 * (1 - 16 * kRoundoff)) {
    return {Decision::yes, Level::filter};
  }
  double unread;
  return overlaps(a, b, unread);
}

ExactResult overlaps(const Sphere& a, const Triangle& b, double& depth_at_most_m) {
  const kernel::SquareBracket distance = kernel::quick_square_distance(a.center, b);
  const double radius2 = a.radius_m * a.radius_m;
  depth_at_most_m = kernel::reported_at_most(a.radius_m - std::sqrt(distance.low2_m2), a.radius_m);
  if (in_filter_range(radius2)) {
    if (distance.high2_m2 < radius2 * (1 - 4 * kRoundoff)) return {Decision::yes, Level::filter};
    if (distance.low2_m2 > radius2 * (1 + 4 * kRoundoff)) return {Decision::no, Level::filter};
  }
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

ExactResult overlaps(const Box& a, const Box& b) {
  const Decision quick = quickly_overlaps(a, b);
  if (quick != Decision::undecided) return {quick, Level::filter};
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

ExactResult overlaps(const Box& a, const Capsule& b) {
  const Decision quick = quickly_overlaps(a, b);
  if (quick != Decision::undecided) return {quick, Level::filter};
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

ExactResult overlaps(const Box& a, const Triangle& b) {
  const Decision quick = quickly_overlaps(a, b);
  if (quick != Decision::undecided) return {quick, Level::filter};
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

ExactResult overlaps(const Box& a, const Triangle& b, double& depth_at_most_m) {
  const ExactResult verdict = overlaps(a, b);
  double reach_m = 0;
  if (verdict.yes()) depth_at_most_m = kernel::push_at_most(a, b, reach_m);
  depth_at_most_m = kernel::reported_at_most(depth_at_most_m, reach_m);
  return verdict;
}

ExactResult overlaps(const Capsule& a, const Capsule& b) {
  const Decision quick = quickly_overlaps(a, b);
  if (quick != Decision::undecided) return {quick, Level::filter};
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

ExactResult overlaps(const Capsule& a, const Triangle& b) {
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

ExactResult overlaps(const Triangle& a, const Triangle& b) {
  const Decision quick = quickly_overlaps(a, b);
  if (quick != Decision::undecided) return {quick, Level::filter};
  return climb([&]<class N>() { return sets_meet<N>(a, b); });
}

ExactResult overlaps(const Primitive& a, const Primitive& b) {
  return std::visit([](const auto& first, const auto& second) { return overlaps(first, second); }, a, b);
}

ExactResult overlaps(const Primitive& a, const Triangle& b) {
  return std::visit([&](const auto& solid) { return overlaps(solid, b); }, a);
}

}  // namespace collided::engine
