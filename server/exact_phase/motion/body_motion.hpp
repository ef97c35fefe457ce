#pragma once

#include "server/geometry/pose.hpp"

namespace collided::engine {

/// A body on its way from one pose to the next while time runs from 0 to 1: its frame's origin goes straight at even
/// speed, and the body turns at even angular speed about a fixed axis through that origin, the short way round (after
/// half a turn: either way).
struct BodyMotion {
  Frame from;
  Frame to;
  Vec3 travel = Vec3::Zero();  // of the frame's origin, metres
  Vec3 axis = Vec3::Zero();    // of the turn, in the world, of unit length; zero without one
  double turn_rad = 0;         // in [0, pi]

  BodyMotion() = default;
  BodyMotion(const Frame& from, const Frame& to);
  static BodyMotion resting(const Frame& frame) { return {frame, frame}; }

  /// The frame at time t; `from` at 0 and `to` at 1 to the bit, and else within error_m of the way.
  Frame at(double t) const;
  /// How far a point at most reach_m from the frame's origin, placed at at(t), may be from the way; 0 for a body at rest.
  double error_m(double reach_m) const;
  /// How far such a point goes at most in all.
  double length_m(double reach_m) const { return travel.norm() + turn_rad * reach_m; }

  /// Of the body's point that is there at time t, where the way takes way_s seconds, m/s.
  /// slack_s  the time itself is known to so much
  struct PointVelocity {
    Vec3 mps = Vec3::Zero();
    double error_mps = 0;  // |truth - mps| <= error_mps
  };
  PointVelocity velocity(const Vec3& point, double t, double motion_s, double slack_s) const;
};

}  // namespace collided::engine
