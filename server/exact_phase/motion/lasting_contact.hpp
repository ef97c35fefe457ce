#pragma once

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/exact_phase/motion/part_motion.hpp"
#include "server/exact_phase/part.hpp"

namespace collided::engine {

/// A part in its body's frame, on the body's motion; both must outlive it.
struct PartOnMotion {
  const ConvexPart& own;
  const BodyMotion& motion;

  ConvexPart at(double t) const;
};

/// Points of contacts of the two parts at the ends of a span, in the coordinates of their motions; null: unknown.
struct KnownContacts {
  const Vec3* low = nullptr;
  const Vec3* high = nullptr;
  double off_m = 0;  // twice the error of the points
};

/// How far two convex parts, which touch at both ends of a span, are from being known to touch throughout: 0 if they
/// do, to within off_m; infinite if they are apart at an end; else about the factor by which the rotations may move
/// their common points too far apart in between, which decreases at least with the span's length.
///
/// Two that only translate touch throughout: the times at which convex sets in relative translation share a point are
/// an interval. Else let a0 and b0 be points of the two that coincide at the begin, a1 and b1 at the end. At the
/// fraction s of the span a0 + s (a1 - a0) and b0 + s (b1 - b0), fixed in the bodies except for s, are apart by at most
/// s (1 - s) (turn of a) (|a1 - a0| + (turn of a) (distance from the axis) / 2), and the same for b, since the
/// translations cancel and an arc leaves its chord by at most an eighth of radius * angle^2. Balls around the points
/// inside the parts bridge that: of radius r0 at the begin and r1 at the end they leave (1 - s) r0 + s r1, and
/// s (1 - s) D is never more if D <= (sqrt r0 + sqrt r1)^2.
///
/// off_m  how far the placed parts may be from their motion, in all
/// cost   some hundred nanoseconds if the contacts at both ends are known
double shortfall_between(const PartOnMotion& a, const PartOnMotion& b, const TimeSpan& span, double off_m,
                         const KnownContacts& known = {});

}  // namespace collided::engine
