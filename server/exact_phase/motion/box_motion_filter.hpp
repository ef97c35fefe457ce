#pragma once

#include "server/geometry/pose.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// A box on its motion between two frames.
struct MovingBox {
  Box at_end;
  Box at_start;
  Vec3 travel = Vec3::Zero();  // of the frame's origin
  double turn_m = 0;           // most that rotation moves any point, anywhere on the motion
  double bend_m = 0;           // most that rotation moves it off the line between its places at both ends
  double error_m = 0;          // error of both numbers, of placing, and of BodyMotion

  /// reach_m: largest distance of a point of the box from the frame's origin.
  MovingBox(const Box& own, const Frame& before, const Frame& now, double reach_m);
};

/// True if two moving boxes certainly never meet, for the numbers given and at every frame of BodyMotion: one of the
/// axes that can separate them at the end does so throughout, in plain double with one bound for all roundings. False
/// proves nothing.
///
/// cost  about 100 ns, against 2 to 5 us for a test at the end and the time of contact; no allocation
bool surely_apart(const MovingBox& a, const MovingBox& b);

}  // namespace collided::engine::kernel
