#include "server/exact_phase/solid/point_signs.hpp"

#include "server/geometry/orientation.hpp"

namespace collided::engine {
namespace {

using kernel::Sign;
using kernel::Vector;

/// (v - u) x (point - u) of the two coordinates that follow the axis, in order; the point is given times its weight.
template <class N>
N turn_of(const Vec3& u, const Vec3& v, const N& y, const N& z, const N& weight, int axis) {
  const int i = (axis + 1) % 3;
  const int j = (axis + 2) % 3;
  const N along_y = N(v[i]) - N(u[i]);
  const N along_z = N(v[j]) - N(u[j]);
  return along_y * (z - weight * N(u[j])) - along_z * (y - weight * N(u[i]));
}

template <class N>
N height_of(const Triangle& t, const Vector<N>& point, const N& weight) {
  const Vector<N> a(t.a);
  return dot(cross(Vector<N>(t.b) - a, Vector<N>(t.c) - a), point - weight * a);
}

}  // namespace

int PlainPoint::turn(const Vec3& u, const Vec3& v, int axis) {
  const double y = at_[(axis + 1) % 3];
  const double z = at_[(axis + 2) % 3];
  const Sign quick = kernel::sign(turn_of<Bounded>(u, v, y, z, 1.0, axis));
  if (quick != Sign::unsure) return static_cast<int>(quick);
  level_ = std::max(level_, Level::expansion);
  const Sign slow = kernel::sign(turn_of<Expansion>(u, v, y, z, 1.0, axis));
  if (slow != Sign::unsure) return static_cast<int>(slow);
  level_ = Level::rational;
  return turn_of<Dyadic>(u, v, y, z, 1.0, axis).sign();
}

int PlainPoint::height(const Triangle& triangle) {
  const OrientedPlane plane(triangle.a, triangle.b, triangle.c);
  const int quick = plane.quick_side(at_);
  if (quick != 0) return quick;
  level_ = std::max(level_, Level::expansion);
  if (const std::optional<int> slow = plane.side(at_)) return *slow;
  level_ = Level::rational;
  return height_of<Dyadic>(triangle, Vector<Dyadic>(at_), 1.0).sign();
}

int QuotientPoint::beyond(double coordinate, int axis) const {
  return (weight_ * Dyadic(coordinate) - along(axis)).sign();
}

int QuotientPoint::turn(const Vec3& u, const Vec3& v, int axis) const {
  return turn_of<Dyadic>(u, v, along((axis + 1) % 3), along((axis + 2) % 3), weight_, axis).sign();
}

int QuotientPoint::height(const Triangle& triangle) const { return height_of<Dyadic>(triangle, at_, weight_).sign(); }

}  // namespace collided::engine
