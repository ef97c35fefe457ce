#pragma once

#include "server/exact_phase/overlap_kernel.hpp"

namespace collided::kernel {

// Whether a closed set holds a point, over any number type.

template <class N>
Decision holds_point(const Cylinder& c, const Vec3& point) {
  const Vector<N> axis = Vector<N>(c.b) - Vector<N>(c.a);
  const Vector<N> to = Vector<N>(point) - Vector<N>(c.a);
  const N length2 = square(axis);
  const N along = dot(to, axis);
  AllOf all;
  if (all.add(at_most(N(0.0), along)) || all.add(at_most(along, length2))) return Decision::no;
  all.add(at_most(square(cross(to, axis)), N(c.radius_m) * N(c.radius_m) * length2));
  return all.result();
}

template <class N>
Decision holds_point(const Cone& c, const Vec3& point) {
  const Vector<N> axis = Vector<N>(c.base) - Vector<N>(c.apex);
  const Vector<N> to = Vector<N>(point) - Vector<N>(c.apex);
  const N length2 = square(axis);
  const N along = dot(to, axis);
  AllOf all;
  if (all.add(at_most(N(0.0), along)) || all.add(at_most(along, length2))) return Decision::no;
  const N wide = N(c.radius_m) * along;
  all.add(at_most(square(cross(to, axis)) * length2, wide * wide));
  return all.result();
}

/// The coordinates along the axes by Cramer's rule: u_i half_i det = to . (the cross product of the other two axes).
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
  // Flat ellipsoids are refused at intake; here they would hold their whole plane.
  if (all.add(opposite(is_zero(determinant)))) return Decision::undecided;
  all.add(at_most(sum, determinant * determinant));
  return all.result();
}

template <class N, class Shape>
Decision holds_point(const Shape& shape, const Vec3& point) {
  return sets_meet<N>(Sphere{point, 0}, shape);
}

}  // namespace collided::kernel
