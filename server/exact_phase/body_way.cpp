#include "server/exact_phase/body_way.hpp"

#include "server/geometry/tolerance.hpp"

namespace collided {

BodyWay::BodyWay(const Frame& first, const Frame& last) : from(first), to(last), travel(last.position - first.position) {
  if (first.rotation == last.rotation) return;
  const Eigen::AngleAxisd about(Mat3(last.rotation * first.rotation.transpose()));
  axis = about.axis();
  turn_rad = about.angle();
}

Frame BodyWay::at(double t) const {
  if (t <= 0) return from;
  if (t >= 1) return to;
  const Vec3 position = (1 - t) * from.position + t * to.position;
  if (turn_rad == 0) return {.rotation = from.rotation, .position = position};
  return {.rotation = Eigen::AngleAxisd(t * turn_rad, axis).toRotationMatrix() * from.rotation, .position = position};
}

double BodyWay::error_m(double reach_m) const {
  if (turn_rad == 0 && from.position == to.position) return 0;
  return kWayError * (from.position.cwiseAbs().maxCoeff() + to.position.cwiseAbs().maxCoeff() + reach_m);
}

}  // namespace collided
