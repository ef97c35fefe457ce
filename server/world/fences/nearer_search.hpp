#pragma once

#include "server/world/fences/gap_search.hpp"

namespace collided::engine {

/// Bounds of the distance of two objects, metres; of two that touch both are 0.
struct GapBounds {
  double low_m = 0;
  double high_m = 0;
  ObjectClearance at = {};  // where they do not touch and are within the limit
};

/// limit_m  beyond it the distance is not measured: then high_m is infinite
GapBounds gap_bounds(const Placed& a, const Placed& b, double limit_m, WalkCost& cost);

/// What a distance is compared with: that of another body and more, or a length alone.
struct GapSide {
  const GapBody* body = nullptr;  // null: more_m is all
  double more_m = 0;
};

/// When one side of a comparison first is surely less than the other. Times are fractions of the motion, 0 to 1.
struct NearerTime {
  bool yes = false;
  bool is_cut_short = false;  // the search stopped at most_looks; not before bracket.low
  TimeBracket bracket;        // not before low; at high it surely is
};

/// The first time at which `nearer` is surely less than `bar`, both measured from one moving body; where the bar is a
/// length alone, not more. Time is halved until each part is sure: of convex bodies that only translate, whose distances
/// are convex over time, by planes and chords; else by the lengths of paths.
///
/// cost     some tens of looks, each two distances; up to most_looks where the two stay as near
/// threads  any
NearerTime first_nearer(const GapBody& from, const GapSide& nearer, const GapSide& bar, const GapOptions& options,
                        WalkCost& cost);

}  // namespace collided::engine
