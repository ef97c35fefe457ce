#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/given/given_part.hpp"
#include "server/exact_phase/part.hpp"

namespace collided::engine {

struct GivenPair;  // given_overlap.hpp

/// A distance in metres, the sum of two doubles, which is not rounded. Both finite, 0 or more.
struct GapLimit {
  double gap_m = 0;
  double more_m = 0;

  /// Numbers that the sum surely does not exceed, and surely does not fall below.
  double high_m() const;
  double low_m() const;
};

/// Whether two closed sets come within the limit of each other where their poses put them; exactly at it is within. As
/// overlaps_as_given, which is this with a limit of 0.
///
/// returns  undecided for pairs with a cylinder, a cone or an ellipsoid, for two half-spaces, and where a number is not
///          finite
/// cost     10 us to some ms; allocates
/// threads  pure
Decision within_as_given(const ConvexPart& placed_a, const ConvexPart& placed_b, const GivenPair& given,
                         const GapLimit& limit);

}  // namespace collided::engine
