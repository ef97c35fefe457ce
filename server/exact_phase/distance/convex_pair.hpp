#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/distance/separation.hpp"
#include "server/geometry/function_ref.hpp"

namespace collided::engine::kernel {

/// Two convex sets, and a test of whether both contain a point.
struct ConvexPair {
  Convex a;
  Convex b;
  /// Exact; yes proves that the sets overlap.
  using BothHold = FunctionRef<ExactResult(const Vec3& point)>;
  BothHold both_hold = leave_open;

  /// Use it if overlap is already decided.
  static ExactResult leave_open(const Vec3&) { return {Decision::undecided, Level::filter}; }
};

/// Whether two convex sets share a point. A search in plain double proposes, a certificate decides: a plane between the
/// sets, by the sign of a sum of two roots over the ladder; a ball inside the difference set; a point in both sets; for
/// sets of flat facets and balls, the same search in rationals; else the algebra of round_pair.hpp, and if that is
/// inconclusive, the search in 256 bits.
///
/// returns  undecided only for two sets with round parts that touch to within kFinestGap, if neither algebra nor
///          coordinates of few digits decide; and for a hull of more than a thousand corners, bent by a rotation,
///          against a cylinder or cone
/// threads  pure; allocates only beyond Level::filter
ExactResult sets_overlap(const ConvexPair& pair);

/// Decides by rationals alone, for audits: no ball, no bound, only planes, points and algebra.
Decision sets_overlap_by_rationals(const ConvexPair& pair);

/// Same as in contact.hpp, for a pair that overlaps. The depth is bracketed by a ball inside the difference set and a
/// push that separates the two.
Contact contact_of(const ConvexPair& pair);

/// The distance of two sets that do not overlap.
Separation separation_of(const ConvexPair& pair);

}  // namespace collided::engine::kernel
