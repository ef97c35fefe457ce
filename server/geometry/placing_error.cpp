#include "server/geometry/placing_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "server/geometry/lost_in_sum.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

/// Compares in an order in which a rotation usually shows at once.
bool is_identity(const Mat3& m) {
  return m(0, 0) == 1 && m(1, 1) == 1 && m(2, 2) == 1 && m(0, 1) == 0 && m(0, 2) == 0 && m(1, 2) == 0 && m(1, 0) == 0 &&
         m(2, 0) == 0 && m(2, 1) == 0;
}

/// True if the frame rotates: then every placed coordinate is rounded.
bool turns(const Frame& frame) { return !is_identity(frame.rotation); }

double lost(double a, double b) { return lost_in_sum(a, b, a + b); }

/// Bounds the error of placing each kind of shape.
class Placing {
 public:
  explicit Placing(const Frame& frame) : frame_(frame), turns_(turns(frame)) {}

  double of_point(const Vec3& own) const {
    if (own.isZero(0)) return 0;
    if (turns_) return rounded_up(kTurnedPoint * own.norm() + kRoundoff * (frame_.position.norm() + own.norm()));
    const Vec3& to = frame_.position;
    return rounded_up(Vec3(lost(own[0], to[0]), lost(own[1], to[1]), lost(own[2], to[2])).norm());
  }
  /// Half axes: a shape rotated in its own frame also has axes from a quaternion.
  double of_axes(const Mat3& axes, const Vec3& half_m) const {
    const bool is_turned = !is_identity(axes);
    if (!turns_ && !is_turned) return 0;
    // Along the axes of the frame the columns are as long as the half axes, which saves three roots.
    const double reach_m = is_turned ? (axes * half_m.asDiagonal()).colwise().norm().sum() : half_m.cwiseAbs().sum();
    return rounded_up((turns_ ? kTurnedPoint * reach_m : 0) + (is_turned ? kTurnedPoint * reach_m : 0));
  }
  /// A disc of radius_m perpendicular to an axis whose ends are off by end_m is rotated as much as the axis.
  double of_disc(const Vec3& from, const Vec3& to, double radius_m) const {
    const double end_m = std::max(of_point(from), of_point(to));
    const double turned = end_m == 0 ? 0 : std::min(2.0, std::numbers::pi * end_m / (to - from).norm());
    return rounded_up(end_m + radius_m * turned);
  }

  double operator()(const Sphere& s) const { return of_point(s.center); }
  double operator()(const Box& b) const { return rounded_up(of_point(b.center) + of_axes(b.axes, b.half_m)); }
  double operator()(const Capsule& c) const { return std::max(of_point(c.a), of_point(c.b)); }
  double operator()(const Cylinder& c) const { return of_disc(c.a, c.b, c.radius_m); }
  double operator()(const Cone& c) const { return of_disc(c.apex, c.base, c.radius_m); }
  double operator()(const Ellipsoid& e) const { return rounded_up(of_point(e.center) + of_axes(e.axes, e.half_m)); }
  double operator()(const Hull& h) const {
    double most_m = 0;
    for (const Vec3& vertex : h.mesh->vertices) most_m = std::max(most_m, of_point(vertex));
    return most_m;
  }
  double operator()(const Triangle& t) const { return std::max({of_point(t.a), of_point(t.b), of_point(t.c)}); }
  double operator()(const HalfSpace& h) const {
    return rounded_up(of_point(h.point) + (turns_ ? 2 * kTurnedPoint * far_m : 0));
  }

  double far_m = 0;

 private:
  static double rounded_up(double error_m) {
    return error_m == 0 ? 0 : error_m * (1 + kBoundSlack) + std::numeric_limits<double>::denorm_min();
  }

  const Frame& frame_;
  bool turns_;
};

}  // namespace

double placing_error_m(const Frame& frame, const Primitive& own, double far_m) {
  Placing placing(frame);
  placing.far_m = far_m;
  return std::visit(placing, own);
}

double placing_error_m(const Frame& frame, const Triangle& own) { return placing_error_of(frame, own); }

template <class Shape>
double placing_error_of(const Frame& frame, const Shape& own) {
  return Placing(frame)(own);
}
template double placing_error_of(const Frame&, const Sphere&);
template double placing_error_of(const Frame&, const Box&);
template double placing_error_of(const Frame&, const Capsule&);
template double placing_error_of(const Frame&, const Cylinder&);
template double placing_error_of(const Frame&, const Cone&);
template double placing_error_of(const Frame&, const Ellipsoid&);
template double placing_error_of(const Frame&, const Hull&);
template double placing_error_of(const Frame&, const Triangle&);

double placing_error_m(const Frame& frame, double reach_m) {
  if (!turns(frame) && frame.position.isZero(0)) return 0;
  const double turned = turns(frame) ? kTurnedPoint * reach_m : 0;
  return (turned + kRoundoff * (frame.position.norm() + reach_m)) * (1 + kBoundSlack) +
         std::numeric_limits<double>::denorm_min();
}

}  // namespace collided::engine
