#include "server/exact_phase/motion/body_motion.hpp"

#include <algorithm>

#include "server/geometry/tolerance.hpp"

namespace collided::engine {

BodyMotion::BodyMotion(const Frame& first, const Frame& last, const Vec3& about)
    : from(first), to(last), travel(last.position - first.position) {
  if (first.rotation == last.rotation) return;
  const Eigen::AngleAxisd rotation(Mat3(last.rotation * first.rotation.transpose()));
  axis = rotation.axis();
  turn_rad = rotation.angle();
  if (about.isZero(0)) return;
  pivot = about;
  pivot_m = about.stableNorm() * (1 + kBoundSlack);
  travel = place(to, pivot) - place(from, pivot);
}

Frame BodyMotion::at(double t) const {
  if (t <= 0) return from;
  if (t >= 1) return to;
  const Vec3 position = (1 - t) * from.position + t * to.position;
  if (turn_rad == 0) return {.rotation = from.rotation, .position = position};
  if (pivot_m > 0) {
    const Mat3 rotation = Eigen::AngleAxisd(t * turn_rad, axis).toRotationMatrix() * from.rotation;
    return {.rotation = rotation, .position = (1 - t) * place(from, pivot) + t * place(to, pivot) - rotation * pivot};
  }
  return {.rotation = Eigen::AngleAxisd(t * turn_rad, axis).toRotationMatrix() * from.rotation, .position = position};
}

double BodyMotion::error_m(double reach_m) const {
  if (turn_rad == 0 && from.position == to.position) return 0;
  const double size_m = from.position.cwiseAbs().maxCoeff() + to.position.cwiseAbs().maxCoeff() + reach_m;
  // The path over the pivot rounds about twice as often.
  return pivot_m > 0 ? 2 * kWayError * (size_m + 2 * pivot_m) : kWayError * size_m;
}

/// The error of position and rotation is that of the motion at that point; within the slack of the time the origin
/// moves on and the point's arm rotates.
BodyMotion::PointVelocity BodyMotion::velocity(const Vec3& point, double t, double motion_s, double slack_s) const {
  const Vec3 arm = point - place(at(t), pivot);
  const Vec3 turn = turn_rad * axis;
  const Vec3 motion = travel + turn.cross(arm);
  const double reach_m = arm.norm();
  const double turned = std::min(slack_s / motion_s, 1.0) * turn_rad;
  const double off_m = 2 * BodyMotion::error_m(reach_m) + turned * (travel.norm() + 2 * turn_rad * reach_m);
  return {.mps = motion / motion_s, .error_mps = (off_m / motion_s) * (1 + kBoundSlack)};
}

}  // namespace collided::engine
