#include "server/exact_phase/distance/witnesses.hpp"

#include <cmath>

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/geometry/guess_tolerance.hpp"

namespace collided::engine::kernel {
namespace {

/// A unit vector without components that are rounding: in axis-aligned scenes the true direction has none.
Vec3 squared_up(const Vec3& n) {
  Vec3 result = unit(n);
  for (double& x : result) x = std::abs(x) < kSquaredUp ? 0 : x;
  return unit(result);
}

}  // namespace

Witnesses::Witnesses(const Convex& a, const Convex& b, const Proposal& proposal, const DepthProposal& depth)
    : normal{squared_up(-proposal.nearest), squared_up(depth.normal), -proposal.nearest, depth.normal} {
  point[1] = a.carrier[0] + depth.on_a;
  point[2] = b.carrier[0] + depth.on_b;
  point[0] = point[1] / 2 + point[2] / 2;
  // The same points projected onto the plane that bounds a: for touching faces the search ends slightly off it.
  for (int which = 0; which < 2; ++which) {
    const Vec3& n = normal[which];
    const Vec3 reached = a.carrier[0] + a.support(n) + a.ball_m * n;
    for (int i = 0; i < 3; ++i) point[3 + 3 * which + i] = point[i] + n.dot(reached - point[i]) * n;
  }
  // Between the nearest points of the two without their balls: the middle of what both balls cover.
  const Vec3 near_a = a.carrier[0] + proposal.on_a();
  const double apart_m = proposal.nearest.stableNorm();
  point[9] = near_a + (a.ball_m + (apart_m - b.ball_m)) / 2 * unit(Vec3(-proposal.nearest));
}

Witnesses::Witnesses(const Convex& a, const Convex& b) {
  const Proposal proposal = nearest_proposal(a, b, Seek::distance);
  *this = Witnesses(a, b, proposal, depth_proposal(a, b, proposal, 0));
}

}  // namespace collided::engine::kernel
