#pragma once

#include <type_traits>

#include "server/geometry/common_origin.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/geometry/pose.hpp"

namespace collided::engine {

/// The motion of a body between two poses while time runs from 0 to 1: its pivot moves straight at constant speed, and
/// the body rotates at constant angular speed around a fixed axis through the pivot, by the smaller angle (a half turn
/// may go in either direction). The pivot is the frame's origin, or for an attached object the origin of its parent's
/// frame.
struct BodyMotion {
  Frame from;
  Frame to;
  Vec3 travel = Vec3::Zero();  // translation of the pivot, metres
  Vec3 axis = Vec3::Zero();    // axis of the rotation, in the world, unit length; zero without rotation
  double turn_rad = 0;         // angle in [0, pi]
  Vec3 pivot = Vec3::Zero();   // in the body's frame, metres; zero without rotation
  double pivot_m = 0;          // upper bound on its length
  /// The pose that `from` was made from, if contacts of the exactly placed shapes are wanted; null: of the shapes
  /// placed by `from`. Must outlive this.
  const Pose* given = nullptr;

  BodyMotion() = default;
  BodyMotion(const Frame& from, const Frame& to, const Vec3& about = Vec3::Zero());
  static BodyMotion resting(const Frame& frame) { return {frame, frame}; }

  /// The motion with time reversed, without a given pose.
  BodyMotion reversed() const { return {to, from, pivot}; }

  /// The frame at time t: exactly `from` at 0 and `to` at 1, in between within error_m of the true motion.
  Frame at(double t) const;
  /// For a body whose points are at most reach_m from the frame's origin: rotation moves a point at most by the angle
  /// times this, and off the line between its places at both ends at most by an eighth of the squared angle times this.
  double lever_m(double reach_m) const { return reach_m + 2 * pivot_m; }
  /// How far a point placed by at(t), at most reach_m from the frame's origin, may be from the true motion, metres; 0
  /// for a body at rest.
  double error_m(double reach_m) const;
  /// How far a shape may be from its place by the given pose, in addition to error_m: metres; 0 without a pose, and if
  /// placing rounds nothing.
  template <class Shape>
  double placing_m(const Shape& own) const {
    if (given == nullptr) return 0;
    const double first_m = placing_error_of(from, own);
    // The error at the end of a straight motion is in error_m, except for discs, which tilt more far from the origin.
    constexpr bool has_disc = std::is_same_v<Shape, Cylinder> || std::is_same_v<Shape, Cone>;
    const bool is_within_error = turn_rad == 0 && (!has_disc || from.position == to.position);
    return is_within_error ? first_m : first_m + placing_error_of(to, own);
  }
  /// Bound for any point within reach_m of the frame's origin.
  double placing_m(double reach_m) const {
    if (given == nullptr) return 0;
    return placing_error_m(from, reach_m) + (turn_rad == 0 ? 0 : placing_error_m(to, reach_m));
  }
  /// An upper bound on the length of such a point's path.
  double length_m(double reach_m) const { return travel.norm() + turn_rad * lever_m(reach_m); }

  /// The velocity of the body's point that is at `point` at time t, if the motion takes motion_s seconds, m/s.
  /// slack_s  uncertainty of the time itself
  struct PointVelocity {
    Vec3 mps = Vec3::Zero();
    double error_mps = 0;  // |truth - mps| <= error_mps
  };
  PointVelocity velocity(const Vec3& point, double t, double motion_s, double slack_s) const;
};

/// The motion in coordinates relative to the origin (common_origin.hpp), without a given pose.
inline BodyMotion seen_from(const Vec3& origin, const BodyMotion& motion) {
  BodyMotion seen = motion;
  seen.from = seen_from(origin, motion.from);
  seen.to = seen_from(origin, motion.to);
  if (motion.pivot_m > 0) seen.travel = place(seen.to, seen.pivot) - place(seen.from, seen.pivot);
  seen.given = nullptr;
  return seen;
}

}  // namespace collided::engine
