#pragma once

#include "server/geometry/pose.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// How far any point of the shape, placed by place(frame, own), may be from its exact position: the unrounded rotation
/// that the quaternion describes, (v -> q v q*) / |q|^2, plus the unrounded translation. The frame must come from a
/// quaternion divided once by its norm. Metres; 0 if nothing is rounded.
///
/// far_m    for a half-space, whose error grows with distance: the relevant distance from its point
/// cost     some 10 ns; for a hull, linear in its corners
double placing_error_m(const Frame& frame, const Primitive& own, double far_m = 0);
double placing_error_m(const Frame& frame, const Triangle& own);
/// Bound for a bounded shape of a known kind, without conversion to a Primitive.
template <class Shape>
double placing_error_of(const Frame& frame, const Shape& own);

/// Bound for any point within reach_m of the frame's origin.
double placing_error_m(const Frame& frame, double reach_m);

}  // namespace collided::engine
