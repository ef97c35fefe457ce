#pragma once

#include "server/exact_phase/round_solids/exact_solid.hpp"

namespace collided::engine::kernel {

/// A convex set, in exact coordinates and in double.
struct RoundSet {
  const ExactSolid& exact;
  const Convex& rounded;
  double off_m = 0;  // bound on the distance between points of `rounded` and of `exact`, with its factor divided out
};

/// Whether two convex sets, at least one of which has a round side other than a ball's, share a point: by exact
/// algebra, for every pair of features. A flat set needs its border if the other is a cylinder or cone.
///
/// returns  undecided if no closed form is known here: the side of a cone against round solids, unless axes are
///          parallel; and a cylinder or capsule that touches so near to the end of its side that double cannot decide
///          on which side of the end
/// cost     10 us to some ms; allocates
Decision round_sets_meet(const RoundSet& a, const RoundSet& b);

/// Takes sets given exactly by their doubles.
ExactResult round_sets_meet(const Convex& a, const Convex& b);

/// Whether a set contains a point.
Decision holds_point(const ExactSolid& set, const Vector<Dyadic>& point);

}  // namespace collided::engine::kernel
