#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// Whether two closed sets share a point; exact for the given doubles; touching counts. The order of the arguments does
/// not matter.
///
/// threads  pure; allocates only on Level::rational
ExactResult overlaps(const Sphere& a, const Sphere& b);
ExactResult overlaps(const Sphere& a, const Box& b);
ExactResult overlaps(const Sphere& a, const Capsule& b);
ExactResult overlaps(const Sphere& a, const Triangle& b);
ExactResult overlaps(const Box& a, const Box& b);
ExactResult overlaps(const Box& a, const Capsule& b);
ExactResult overlaps(const Box& a, const Triangle& b);
ExactResult overlaps(const Capsule& a, const Capsule& b);
ExactResult overlaps(const Capsule& a, const Triangle& b);
ExactResult overlaps(const Triangle& a, const Triangle& b);

/// Also sets an upper bound on contact(a, b).depth_m (may be infinite), so that most contacts need not be computed to
/// find the deepest.
ExactResult overlaps(const Sphere& a, const Triangle& b, double& depth_at_most_m);
ExactResult overlaps(const Box& a, const Triangle& b, double& depth_at_most_m);

inline ExactResult overlaps(const Box& a, const Sphere& b) { return overlaps(b, a); }
inline ExactResult overlaps(const Capsule& a, const Sphere& b) { return overlaps(b, a); }
inline ExactResult overlaps(const Triangle& a, const Sphere& b) { return overlaps(b, a); }
inline ExactResult overlaps(const Capsule& a, const Box& b) { return overlaps(b, a); }
inline ExactResult overlaps(const Triangle& a, const Box& b) { return overlaps(b, a); }
inline ExactResult overlaps(const Triangle& a, const Capsule& b) { return overlaps(b, a); }

ExactResult overlaps(const Primitive& a, const Primitive& b);
ExactResult overlaps(const Primitive& a, const Triangle& b);

}  // namespace collided::engine
