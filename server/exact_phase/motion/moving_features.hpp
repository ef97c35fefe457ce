#pragma once

#include "server/exact_phase/motion/time_of_contact.hpp"

namespace collided::engine {

/// A point that moves from start to end at constant speed while time runs from 0 to 1.
struct MovingPoint {
  Vec3 start;
  Vec3 end;
};

/// At each time the segment between its moving ends; possibly a point.
struct MovingSegment {
  MovingPoint a;
  MovingPoint b;
};

/// At each time the triangle of its moving corners; possibly a segment or a point. It may leave its plane, flip and
/// shrink to nothing during the motion.
struct MovingTriangle {
  MovingPoint a;
  MovingPoint b;
  MovingPoint c;
};

/// Whether the two meet at a time in [0, 1], and a bracket of the first such time, no wider than `width` unless its
/// ends are neighbouring doubles. Never late, never missed; swapping or reordering changes nothing.
///
/// decision  exact for the given doubles; undecided only for coordinates that are not finite, or if the thread's
///           precision ends below rationals
/// source    the cubic of Provot, "Collision and self-collision handling in cloth model", 1997; its exact decision as
/// called for by Brochu, Edwards, Bridson, "Efficient geometrically exact continuous collision detection", 2012, and
/// Wang et al., "A large-scale benchmark and an inclusion-based algorithm for continuous collision detection", 2021.
/// Here by real roots: Bernstein coefficients and Descartes' rule of signs, then signs of polynomials at isolated roots
/// (Basu, Pollack, Roy, "Algorithms in Real Algebraic Geometry", 2006, ch. 10)
ExactResult first_contact(const MovingPoint& point, const MovingTriangle& face, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingSegment& a, const MovingSegment& b, double width, TimeBracket& bracket);
ExactResult first_contact(const MovingTriangle& a, const MovingTriangle& b, double width, TimeBracket& bracket);

}  // namespace collided::engine
