#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/kernels/straight_motion.hpp"

namespace collided::engine::kernel {

/// Whether two polytopes, each with a ball around every point, share a point; by rationals alone.
///
/// returns  undecided only where a coordinate is not finite
/// cost     0.1 to 10 ms; allocates
/// source   Gilbert, Johnson, Keerthi 1988 as in simplex_search.hpp; in exact arithmetic every step comes nearer, so
///          the search over finitely many simplices terminates
Decision polytopes_meet(const Convex& a, const Convex& b);

/// Decides for any time of a's motion relative to b.
Decision polytopes_meet_on_motion(const Convex& a, const Convex& b, const StraightMotion& motion);

/// The points whose hull is the set without its ball: the eight corners of a box, else the carriers.
std::vector<Vector<Dyadic>> corners_of(const Convex& set);
/// The corners of the volume that the set sweeps during a translation.
std::vector<Vector<Dyadic>> corners_swept(const Convex& set, const Vector<Dyadic>& displacement);

/// Whether the hulls of two sets of points come within radius_m of each other; decided as polytopes_meet().
Decision hulls_meet(const std::vector<Vector<Dyadic>>& a, const std::vector<Vector<Dyadic>>& b, const Dyadic& radius_m);
/// Whether the hull of the points comes within radius_m of the origin; decided as polytopes_meet().
Decision hull_meets_ball(const std::vector<Vector<Dyadic>>& points, const Dyadic& radius_m);

/// A point of both sets, exactly, as point / divisor, and the nearby points of the two hulls as weights of corners (the
/// eight of a box, else the carriers), positive and not normalised. Without balls the hull points equal the common
/// point.
struct CommonPoint {
  using Mix = std::vector<std::pair<std::uint32_t, Dyadic>>;
  Vector<Dyadic> point;
  Dyadic divisor;
  Mix mix_a = {};
  Mix mix_b = {};
};

/// Nothing if the sets do not meet, or a number is not finite. Both must be polytopes.
std::optional<CommonPoint> common_point(const Convex& a, const Convex& b);

}  // namespace collided::engine::kernel
