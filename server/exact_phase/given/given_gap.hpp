#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/given/given_part.hpp"
#include "server/exact_phase/part.hpp"

namespace collided::engine {

struct GivenPair;  // given_overlap.hpp

/// A distance in metres, the unrounded sum of two doubles. Both finite, 0 or more.
struct GapLimit {
  double gap_m = 0;
  double more_m = 0;

  /// Numbers that the sum certainly does not exceed, and certainly does not fall below.
  double high_m() const;
  double low_m() const;
};

/// Whether two closed sets, placed exactly by their poses, come within the limit of each other, equality included. With
/// a limit of 0 it is overlaps_as_given().
///
/// returns  undecided for pairs with a cylinder, a cone or an ellipsoid, for two half-spaces, and if a number is not
///          finite
/// cost     10 us to some ms; allocates
/// threads  pure
Decision within_as_given(const ConvexPart& placed_a, const ConvexPart& placed_b, const GivenPair& given,
                         const GapLimit& limit);

}  // namespace collided::engine
