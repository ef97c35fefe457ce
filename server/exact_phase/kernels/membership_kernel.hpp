#pragma once

#include "server/exact_phase/kernels/overlap_kernel.hpp"

namespace collided::engine::kernel {

// Whether a closed set contains a point, over any number type.

/// The position of a point relative to an axis with two ends.
template <class N>
struct AlongAxis {
  N length2;
  N along;    // along the axis, times its length
  N across2;  // squared distance from the line, times length2
  Decision is_between;

  AlongAxis(const Vec3& from, const Vec3& end, const Vec3& point) {
    const Vector<N> axis = Vector<N>(end) - Vector<N>(from);
    const Vector<N> to = Vector<N>(point) - Vector<N>(from);
    length2 = square(axis);
    along = dot(to, axis);
    across2 = square(cross(to, axis));
    is_between = both(at_most(N(0.0), along), at_most(along, length2));
  }
};

template <class N>
Decision holds_point(const Cylinder& c, const Vec3& point) {
  const AlongAxis<N> at(c.a, c.b, point);
  return both(at.is_between, at_most(at.across2, N(c.radius_m) * N(c.radius_m) * at.length2));
}

template <class N>
Decision holds_point(const Cone& c, const Vec3& point) {
  const AlongAxis<N> at(c.apex, c.base, point);
  const N wide = N(c.radius_m) * at.along;
  return both(at.is_between, at_most(at.across2 * at.length2, wide * wide));
}

/// Coordinates along the axes by Cramer's rule: u_i half_i det = to . (cross product of the other two axes).
template <class N>
Decision holds_point(const Ellipsoid& e, const Vec3& point) {
  Vector<N> axis[3];
  for (int i = 0; i < 3; ++i) axis[i] = N(e.half_m[i]) * Vector<N>(Vec3(e.axes.col(i)));
  const Vector<N> to = Vector<N>(point) - Vector<N>(e.center);
  const N determinant = dot(axis[0], cross(axis[1], axis[2]));
  N sum(0.0);
  for (int i = 0; i < 3; ++i) {
    const N u = dot(to, cross(axis[(i + 1) % 3], axis[(i + 2) % 3]));
    sum = sum + u * u;
  }
  AllOf all;
  // Flat ellipsoids are refused at intake; here they would contain their whole plane.
  if (all.add(opposite(is_zero(determinant)))) return Decision::undecided;
  all.add(at_most(sum, determinant * determinant));
  return all.result();
}

template <class N, class Shape>
Decision holds_point(const Shape& shape, const Vec3& point) {
  return sets_meet<N>(Sphere{point, 0}, shape);
}

}  // namespace collided::engine::kernel
