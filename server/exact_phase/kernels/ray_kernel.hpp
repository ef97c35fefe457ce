#pragma once

#include "server/exact_phase/kernels/triangle_kernel.hpp"
#include "server/geometry/ray.hpp"

namespace collided::engine::kernel {

/// Where a ray first meets a set, as a multiple of its direction: numerator / denominator, with a positive denominator.
/// Ignores the ray's length.
template <class N>
struct Reach {
  Decision meets = Decision::no;
  N numerator;
  N denominator;
};

template <class N>
struct Line {
  Vector<N> origin;
  Vector<N> direction;

  explicit Line(const Ray& ray) : origin(ray.origin), direction(ray.direction) {}
};

template <class N>
Reach<N> ray_to_parallel_segment(const Line<N>& ray, const Vector<N>& to_a, const Vector<N>& to_b) {
  const Vector<N>& d = ray.direction;
  const Decision on_line = both(is_zero(cross(to_a, d)), is_zero(cross(to_b, d)));
  const N a = dot(to_a, d);
  const N b = dot(to_b, d);
  return {both(on_line, at_most(N(0.0), max(a, b))), max(N(0.0), min(a, b)), square(d)};
}

template <class N>
Reach<N> ray_to_segment(const Line<N>& ray, const Segment<N>& s) {
  const Vector<N>& d = ray.direction;
  const Vector<N>& e = s.d;
  const Vector<N> to_a = s.a - ray.origin;
  const Vector<N> n = cross(d, e);
  const int axis = dropped_axis(n);
  if (axis < 0) return {Decision::undecided, N(0.0), N(1.0)};
  if (axis == 3) return ray_to_parallel_segment(ray, to_a, s.b - ray.origin);
  const N nn = square(n);
  const N along_ray = dot(cross(to_a, e), n);
  const N along_segment = dot(cross(to_a, d), n);
  AllOf all;
  all.add(is_zero(dot(to_a, n)));
  all.add(at_most(N(0.0), along_ray));
  all.add(at_most(N(0.0), along_segment));
  all.add(at_most(along_segment, nn));
  return {all.result(), along_ray, nn};
}

/// For a ray in the triangle's plane, or a triangle that spans no plane.
template <class N>
Reach<N> ray_to_flat_facet(const Line<N>& ray, const Facet<N>& f) {
  const int axis = dropped_axis(f.normal);
  Reach<N> first{Decision::undecided, N(0.0), N(1.0)};
  if (axis < 0) return first;
  first.meets = axis < 3 ? point_in_facet(ray.origin, f, axis) : Decision::no;
  for (int i = 0; i < 3 && first.meets != Decision::undecided; ++i) {
    const Reach<N> next = ray_to_segment(ray, f.side(i));
    if (next.meets == Decision::no) continue;
    if (next.meets == Decision::undecided) return next;
    const Decision nearer = first.meets == Decision::no
                                ? Decision::yes
                                : less(next.numerator * first.denominator, first.numerator * next.denominator);
    if (nearer == Decision::yes) first = next;
    if (nearer == Decision::undecided) first.meets = nearer;
  }
  return first;
}

/// The side on which the ray's line passes each edge: edge . (corner - origin) x direction (the line's moment about the
/// edge, half of its Pluecker product). Edge i runs from corner i to i + 1; the three sum to -(direction . normal).
template <class N>
std::array<N, 3> edge_sides(const Line<N>& ray, const Facet<N>& f) {
  std::array<N, 3> side;
  for (int i = 0; i < 3; ++i) side[i] = dot(f.edge[i], cross(f.corner[i] - ray.origin, ray.direction));
  return side;
}

/// against: whether the direction points against the normal.
template <class N>
Reach<N> ray_to_plane(const Line<N>& ray, const Facet<N>& f, bool against) {
  N numerator = dot(f.corner[0] - ray.origin, f.normal);
  N denominator = dot(ray.direction, f.normal);
  if (against) {
    numerator = -numerator;
    denominator = -denominator;
  }
  const Decision ahead = at_most(N(0.0), numerator);
  return {ahead, numerator, denominator};
}

template <class N>
Reach<N> ray_to_facet(const Line<N>& ray, const Facet<N>& f) {
  bool negative = false;
  bool positive = false;
  bool unsure = false;
  for (const N& side : edge_sides(ray, f)) {
    const Sign s = sign(side);
    unsure = unsure || s == Sign::unsure;
    negative = negative || s == Sign::negative;
    positive = positive || s == Sign::positive;
  }
  if (negative && positive) return {Decision::no, N(0.0), N(1.0)};
  if (unsure) return {Decision::undecided, N(0.0), N(1.0)};
  if (!negative && !positive) return ray_to_flat_facet(ray, f);
  return ray_to_plane(ray, f, positive);
}

/// Whether numerator / denominator * |direction| <= length_m.
template <class N>
Decision within_length(const Reach<N>& reach, const Ray& ray) {
  if (std::isinf(ray.length_m)) return Decision::yes;
  const N limit = N(ray.length_m) * reach.denominator;
  return at_most(reach.numerator * reach.numerator * square(Vector<N>(ray.direction)), limit * limit);
}

}  // namespace collided::engine::kernel
