#pragma once

#include "server/geometry/pose.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// How far any point of the shape, placed by place(frame, own), may be from where the pose has it: the rotation that the
/// quaternion means, (q v q*) / |q|^2, and the sums of it, not rounded. The frame is that of a quaternion divided by its
/// norm once. Metres; 0 where nothing is rounded.
///
/// far_m    for a half-space, whose error grows: how far from its point it is looked at
/// cost     some 10 ns; of a hull, its corners
double placing_error_m(const Frame& frame, const Primitive& own, double far_m = 0);
double placing_error_m(const Frame& frame, const Triangle& own);

/// The same for any points at most reach_m from the frame's origin.
double placing_error_m(const Frame& frame, double reach_m);

}  // namespace collided::engine
