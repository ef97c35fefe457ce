#include <array>
#include <cmath>

#include "client/draw/drawing/features.hpp"
#include "client/library/asking/exact_sum.hpp"

namespace collided::draw {
namespace {

using client::ExactVector;

ExactVector exactly(const Vec3& v) { return client::exact({v.x(), v.y(), v.z()}); }

/// The error of n . (eye - p) in double, relative to the sum of its terms' magnitudes, is below this: it is made of
/// three subtractions, a cross product and a scalar product.
constexpr double kFilter = 32 * 0x1p-53;

/// The sign of (u x v) . displacement if double decides it; else 0.
int sure_sign(const Vec3& u, const Vec3& v, const Vec3& displacement) {
  const double value = u.cross(v).dot(displacement);
  const double spread = 6 * u.cwiseAbs().maxCoeff() * v.cwiseAbs().maxCoeff() * displacement.cwiseAbs().maxCoeff();
  if (!(std::abs(value) > kFilter * spread) || !(spread > 1e-280)) return 0;
  return value > 0 ? 1 : -1;
}

}  // namespace

bool faces_eye(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& eye) {
  const int sign = sure_sign(b - a, c - a, eye - a);
  if (sign != 0) return sign > 0;
  const ExactVector p = exactly(a);
  return dot(cross(exactly(b) - p, exactly(c) - p), exactly(eye) - p).above_zero();
}

bool faces_direction(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& toward_eye) {
  const int sign = sure_sign(b - a, c - a, toward_eye);
  if (sign != 0) return sign > 0;
  const ExactVector p = exactly(a);
  return dot(cross(exactly(b) - p, exactly(c) - p), exactly(toward_eye)).above_zero();
}

}  // namespace collided::draw
