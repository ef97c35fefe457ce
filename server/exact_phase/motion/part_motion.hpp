#pragma once

#include <cstdint>
#include <variant>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/motion/body_motion.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"

namespace collided::engine {

/// A convex part of a body: a primitive or a triangle.
using ConvexPart =
    std::variant<Sphere, Box, Capsule, Cylinder, Cone, Ellipsoid, Hull, Triangle>;

/// Not of a half-space, which has no end (ground_motion.hpp).
ConvexPart part_of(const Primitive& primitive);

/// A part, in its body's frame, on the body's way. The way must outlive it.
struct PartMotion {
  ConvexPart own;
  const BodyMotion* motion = nullptr;
  double reach_m = 0;  // no point of the part is farther from the frame's origin

  PartMotion(ConvexPart part, const BodyMotion& on);
  ConvexPart at(double t) const;
};

/// What of the way is looked at.
struct TimeSpan {
  double low = 0;
  double high = 1;
};

/// Whether two convex parts meet on their ways within the span, and the bracket of the first contact: no contact from
/// span.low to bracket.low, contact of the parts placed at bracket.high by the exact test (of two triangles: at some time
/// up to there). Both span.low when they touch there. No wider than `width` but where the first contact is a graze: then
/// as narrow as it is known.
///
/// decision  yes and no are proved: a plane that parts the two is followed along the way with a bound on how far the
///           turns may bend; undecided where they come nearer than rounding tells (or than kMostSteps steps resolve) and
///           no overlap is met. Two triangles, and a box or capsule that goes straight past a resting triangle, are
///           then decided by the exact tests of moving_features.hpp and moving_solids.hpp, others that go straight by
///           swept_convex.hpp
/// error     the parts' way is that of BodyMotion to within its error_m
/// threads   pure
/// source    conservative advancement: Mirtich, "Impulse-based Dynamic Simulation of Rigid Body Systems", 1996; along
///           the normal of the nearest points: Zhang, Lee, Kim, "Interactive Continuous Collision Detection for
///           Non-Convex Polyhedra", 2006; here a plane is tried at both ends of a step, with the bend between them
///
/// looks     grows by the times at which the two were looked at, and more where that took exact arithmetic: what the
///           answer has cost, a few microseconds each
ExactResult first_contact(const PartMotion& a, const PartMotion& b, TimeSpan span, double width, TimeBracket& bracket,
                      std::uint32_t* looks = nullptr);

/// The contact of the two placed at a time at which they overlap; normal from a to b.
Contact contact_at(const PartMotion& a, const PartMotion& b, double t);

}  // namespace collided::engine
