#pragma once

#include "server/exact_phase/motion/time_of_contact.hpp"

namespace collided::engine {

/// On the segment start end, at even speed, while time runs from 0 to 1.
struct MovingPoint {
  Vec3 start;
  Vec3 end;
};

/// What its moving ends span at each time; possibly a point.
struct MovingSegment {
  MovingPoint a;
  MovingPoint b;
};

/// What its moving corners span at each time; possibly a segment or a point. It may bend out of its plane, turn over
/// and shrink to nothing on the way.
struct MovingTriangle {
  MovingPoint a;
  MovingPoint b;
  MovingPoint c;
};

/// Whether there is a time in [0, 1] at which the two meet, and the bracket of the first such time, no wider than
/// `width` unless neighbouring doubles already are. Never late, never missed; swapping or reordering changes nothing.
///
/// decision  exact for the given doubles; undecided only for coordinates that are not finite, or where the thread's
///           precision ends below rationals
/// source    the cubic of Provot, "Collision and self-collision handling in cloth model", 1997; its exact decision as
///           asked for by Brochu, Edwards, Bridson, "Efficient geometrically exact continuous collision detection",
///           2012, and Wang et al., "A large-scale benchmark and an inclusion-based algorithm for continuous collision
///           detection", 2021. Here by real roots: Bernstein coefficients and Descartes' rule of signs, then signs of
///           polynomials at isolated roots (Basu, Pollack, Roy, "Algorithms in Real Algebraic Geometry", 2006, ch. 10)
ExactResult first_contact(const MovingPoint& point, const MovingTriangle& face, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSegment& a, const MovingSegment& b, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingTriangle& a, const MovingTriangle& b, double width, TimeBracket& bracket);

}  // namespace collided::engine
