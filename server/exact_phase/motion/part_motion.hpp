#pragma once

#include <cstdint>
#include <variant>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/given/given_part.hpp"
#include "server/exact_phase/motion/body_motion.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/part.hpp"

namespace collided::engine {

/// A bounded convex part of a body, in the body's frame: any primitive but a half-space, or a triangle.
using BoundedPart = std::variant<Sphere, Box, Capsule, Cylinder, Cone, Ellipsoid, Hull, Triangle>;

/// The primitive as a part; not for a half-space, which has no bounds (ground_motion.hpp).
BoundedPart part_of(const Primitive& primitive);

/// A part, in its body's frame, on the body's motion, which must outlive it.
struct PartMotion {
  BoundedPart own;
  const BodyMotion* motion = nullptr;
  double reach_m = 0;    // largest distance of a point from the frame's origin, metres, as BodyMotion::lever_m
  double placing_m = 0;  // bound on its placing error relative to the given pose; BodyMotion::placing_m

  PartMotion(BoundedPart part, const BodyMotion& on);
  /// The part at time t, in world coordinates.
  BoundedPart at(double t) const;
  ConvexPart placed_at(double t) const;
};

/// A part at the beginning of its motion: placed, in its own frame, and as given (without a pose: as placed).
struct PartAsGiven {
  ConvexPart placed;
  ConvexPart own;
  GivenPart given;  // refers to own

  explicit PartAsGiven(const PartMotion& part);
  PartAsGiven(const PartAsGiven&) = delete;
  PartAsGiven& operator=(const PartAsGiven&) = delete;
};

/// The times to search, as fractions of the motion.
struct TimeSpan {
  double low = 0;
  double high = 1;
};

/// Whether two convex parts meet during their motions within the span, and a bracket of the first contact: no contact
/// from span.low to bracket.low; contact of the parts placed at bracket.high by the exact test (for two triangles: at
/// some time up to it). Both are span.low if they touch there. No wider than `width`, except if the first contact is a
/// graze: then as narrow as it is known.
///
/// If a pose is given and placing rounds (placing_m above 0), all this holds for the exactly placed parts. Exceptions
/// are parts that rotate, and pairs of cylinder, cone and ellipsoid: if they come closer than placing_m, a yes is that
/// of the placed ones.
///
/// decision  yes and no are proved: a plane between the two is followed along the motion, with a bound on what the
///           rotations can change; undecided if they come closer than rounding resolves (or than kMostSteps steps
///           resolve) and no overlap is found. Two triangles, and a box or capsule that moves straight past a resting
///           triangle, are then decided by the exact tests of moving_features.hpp and moving_solids.hpp, other straight
///           motions by swept_convex.hpp
/// error     the parts' motion is that of BodyMotion to within its error_m
/// threads   pure
/// source    conservative advancement: Mirtich, "Impulse-based Dynamic Simulation of Rigid Body Systems", 1996; along
/// the normal of the nearest points: Zhang, Lee, Kim, "Interactive Continuous Collision Detection for Non-Convex
/// Polyhedra", 2006; here a plane is tested at both ends of a step, with the bend between them
///
/// looks     grows by the number of times at which the two were tested, more for exact arithmetic: the cost of the
///           answer, a few microseconds each; may be null
ExactResult first_contact(const PartMotion& a, const PartMotion& b, TimeSpan span, double width, TimeBracket& bracket,
                          std::uint32_t* looks = nullptr);

/// The contact of the two placed at a time at which they overlap; the normal points from a to b.
Contact contact_at(const PartMotion& a, const PartMotion& b, double t);

}  // namespace collided::engine
