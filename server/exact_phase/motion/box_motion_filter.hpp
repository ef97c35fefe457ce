#pragma once

#include "server/geometry/pose.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// A box on its motion between two frames: at the motion's end, how far the frame's origin travelled, and how far off
/// the box may be elsewhere on the motion if it is moved back without turning.
struct MovingBox {
  Box at_end;
  Vec3 travel = Vec3::Zero();
  double off_m = 0;

  /// reach_m: no point of the box is farther from the frame's origin.
  MovingBox(const Box& own, const Frame& before, const Frame& now, double reach_m);
};

/// Whether two moving boxes certainly never meet, for the numbers given and at every frame of BodyMotion: one of the
/// axes that can separate them at the end does so all the way, in plain double with one bound for all roundings. False
/// proves nothing.
///
/// cost  about 100 ns, against 2 to 5 us for a test at the end and the time of contact; no allocation
bool surely_apart(const MovingBox& a, const MovingBox& b);

}  // namespace collided::engine::kernel
