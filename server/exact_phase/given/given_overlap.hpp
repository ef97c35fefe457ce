#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/given/given_part.hpp"
#include "server/exact_phase/part.hpp"
#include "server/geometry/ray.hpp"

namespace collided::engine {

namespace kernel {
struct StraightMotion;
}

/// Two parts to compare: in world coordinates, in double, and as they were given.
struct GivenPair {
  const GivenPart& a;
  const GivenPart& b;

  /// True if both were given in world coordinates.
  bool is_exact() const { return a.pose == nullptr && b.pose == nullptr; }
};

/// Whether two closed sets share a point, placed by the exact rotation v -> q v q* / |q|^2 and the exact translation:
/// by rationals, since |q|^2 is a common denominator of all coordinates. Touching counts.
///
/// placed_a, placed_b  the parts in world coordinates, used if the given part has no pose
/// returns   undecided only if a number is not finite, for two half-spaces, and for pairs with a cylinder, a cone or an
///           ellipsoid that refined_meet (refined_search.hpp) leaves open
/// cost      10 us to some ms, 100 ms at worst; allocates
/// threads   pure
Decision overlaps_as_given(const ConvexPart& placed_a, const ConvexPart& placed_b, const GivenPair& given);

/// Decides for any time of a's straight motion relative to b; the poses are those at its beginning.
///
/// returns  undecided also for two moving shapes among cylinder, cone and ellipsoid
Decision overlaps_as_given(const ConvexPart& placed_a, const ConvexPart& placed_b, const GivenPair& given,
                           const kernel::StraightMotion& motion);

/// A segment of a ray between two multiples of the direction; its ends need not be doubles.
struct RaySegment {
  const Ray& ray;
  double from;
  double to;
};

/// Decides for a segment and a part.
Decision overlaps_as_given(const RaySegment& segment, const ConvexPart& placed, const GivenPart& given);

}  // namespace collided::engine
