#pragma once

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// The separating-axis test in plain double with one error bound for the whole pair: the first filter for the two most
/// frequent pairs in simulations. Undecided if an axis comes closer to touching than the bound.
///
/// off_m   the answer also holds if the points of the two together are moved by off_m
/// cost    about 60 ns against 700 for the same test with a running bound; no allocation
/// source  axes: Gottschalk, Lin, Manocha, "OBBTree", 1996. Products over cross axes reuse those over the face
///         normals, since a x b . c = b x c . a
Decision quickly_overlaps(const Box& a, const Box& b, double off_m = 0);
Decision quickly_overlaps(const Box& a, const Triangle& b);

/// An upper bound on the shortest push that separates the two along the box's face normals or the triangle's; infinity
/// out of range.
/// reach_m: receives at least the largest distance between two points of the pair.
double push_at_most(const Box& a, const Triangle& b, double& reach_m);

/// Decides two triangles by the signs of their corners relative to each other's plane and of two edges relative to each
/// other, in plain double; undecided if a sign is closer to zero than its bound, for example if an edge meets a corner
/// or both share a plane.
///
/// off_m   the answer also holds if the corners of the two together are moved by off_m
/// cost    about 45 ns separate, 65 crossing, against 700; no allocation
/// source  Guigue, Devillers, "Fast and Robust Triangle-Triangle Overlap Test Using Orientation Predicates", 2003
Decision quickly_overlaps(const Triangle& a, const Triangle& b, double off_m = 0);

}  // namespace collided::engine::kernel
