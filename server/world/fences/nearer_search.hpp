#pragma once

#include "server/world/fences/gap_search.hpp"

namespace collided::engine {

/// Bounds of the distance of two objects, metres; both are 0 if they touch.
struct GapBounds {
  double low_m = 0;
  double high_m = 0;
  ObjectClearance at = {};  // set if they do not touch and are within the limit
};

/// limit_m  a larger distance is not measured: then high_m is infinite
GapBounds gap_bounds(const Placed& a, const Placed& b, double limit_m, WalkCost& cost);

/// One side of a comparison of distances: the distance to a body plus a length, or the length alone.
struct GapSide {
  const GapBody* body = nullptr;  // null: more_m alone
  double more_m = 0;
};

/// When one side of a comparison is first certainly less than the other. Times are fractions of the motion, 0 to 1.
struct NearerTime {
  bool yes = false;
  bool is_cut_short = false;  // the search stopped at most_looks; not before bracket.low
  TimeBracket bracket;        // not before low; certainly at high
};

/// The first time at which `nearer` is certainly less than `bar`, both measured from one moving body; if the bar is a
/// length alone, not more. Halves time until each part is decided: for convex bodies that only translate, whose
/// distances are convex over time, by planes and chords; else by the lengths of paths.
///
/// cost     some tens of evaluations, each two distances; up to most_looks if the two stay equally near
/// threads  any
NearerTime first_nearer(const GapBody& from, const GapSide& nearer, const GapSide& bar, const GapOptions& options,
                        WalkCost& cost);

}  // namespace collided::engine
