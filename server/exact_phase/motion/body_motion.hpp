#pragma once

#include "server/geometry/pose.hpp"

namespace collided::engine {

/// The motion of a body between two poses while time runs from 0 to 1: its frame's origin moves straight at constant
/// speed, and the body rotates at constant angular speed about a fixed axis through that origin, through the smaller
/// angle (a half turn may go in either direction).
struct BodyMotion {
  Frame from;
  Frame to;
  Vec3 travel = Vec3::Zero();  // translation of the frame's origin, metres
  Vec3 axis = Vec3::Zero();    // of the rotation, in the world, unit length; zero without rotation
  double turn_rad = 0;         // in [0, pi]

  BodyMotion() = default;
  BodyMotion(const Frame& from, const Frame& to);
  static BodyMotion resting(const Frame& frame) { return {frame, frame}; }

  /// The frame at time t: exactly `from` at 0 and `to` at 1, in between within error_m of the true motion.
  Frame at(double t) const;
  /// How far a point placed by at(t), at most reach_m from the frame's origin, may be from the true motion, metres; 0
  /// for a body at rest.
  double error_m(double reach_m) const;
  /// An upper bound on the length of such a point's path.
  double length_m(double reach_m) const { return travel.norm() + turn_rad * reach_m; }

  /// The velocity of the body's point that is at `point` at time t, if the motion takes motion_s seconds, m/s.
  /// slack_s  uncertainty of the time itself
  struct PointVelocity {
    Vec3 mps = Vec3::Zero();
    double error_mps = 0;  // |truth - mps| <= error_mps
  };
  PointVelocity velocity(const Vec3& point, double t, double motion_s, double slack_s) const;
};

}  // namespace collided::engine
