#pragma once

#include "server/exact_phase/arithmetic/number.hpp"

namespace collided::engine::kernel {

// Nearness of points and segments by squared distances: whether one set is within R of another, given R^2. The nearest
// pair lies on some pair of features. Testing every pair against R and joining the answers by "or" requires no choice
// of the nearest one, so a tie between features never costs an exact evaluation.
// Source of the features: Ericson, "Real-Time Collision Detection", 2005, 5.1.

template <class N>
struct Segment {
  Vector<N> a;
  Vector<N> b;
  Vector<N> d;  // b - a; kept because a path of length 0 must have a direction of exactly zero

  Segment() = default;
  Segment(const Vector<N>& from, const Vector<N>& to) : a(from), b(to), d(to - from) {}
  Segment(const Vector<N>& from, const Vector<N>& to, const Vector<N>& step) : a(from), b(to), d(step) {}
  static Segment along(const Vector<N>& from, const Vector<N>& step) {
    Segment s;
    s.a = from;
    s.b = from + step;
    s.d = step;
    return s;
  }
};

/// Whether |w| <= R from a segment with direction d; the point w is relative to the segment's start.
template <class N>
Decision point_near_segment(const Vector<N>& w, const Vector<N>& d, const N& R2) {
  const N dd = square(d);
  const Decision near_line = at_most(square(cross(w, d)), R2 * dd);
  // Outside the infinite cylinder. For a segment of length 0 this reads 0 <= 0, which rules nothing out.
  if (near_line == Decision::no) return Decision::no;
  const N along = dot(w, d);
  AnyOf any;
  any.add(both(near_line, both(is_positive(along), less(along, dd))));
  if (any.result() != Decision::yes) any.add(at_most(square(w), R2));
  if (any.result() != Decision::yes) any.add(at_most(square(w - d), R2));
  return any.result();
}

template <class N>
Decision point_near_segment(const Vector<N>& p, const Segment<N>& s, const N& R2) {
  return point_near_segment(p - s.a, s.d, R2);
}

template <class N>
Decision segments_near(const Segment<N>& s, const Segment<N>& t, const N& R2) {
  const Vector<N>& d = s.d;
  const Vector<N>& e = t.d;
  const Vector<N> w = s.a - t.a;
  const Vector<N> n = cross(d, e);
  const N nn = square(n);
  const N height = dot(w, n);
  const Decision lines_near = at_most(height * height, R2 * nn);
  if (lines_near == Decision::no) return Decision::no;
  // Both feet lie strictly inside, which also implies that n is not zero.
  const N along_s = -dot(w, cross(e, n));
  const N along_t = -dot(w, cross(d, n));
  AllOf inner;
  inner.add(lines_near);
  inner.add(is_positive(along_s));
  if (inner.result() != Decision::no) inner.add(less(along_s, nn));
  if (inner.result() != Decision::no) inner.add(is_positive(along_t));
  if (inner.result() != Decision::no) inner.add(less(along_t, nn));
  AnyOf any;
  if (any.add(inner.result())) return Decision::yes;
  if (any.add(point_near_segment(w, e, R2))) return Decision::yes;
  if (any.add(point_near_segment(s.b - t.a, e, R2))) return Decision::yes;
  if (any.add(point_near_segment(-w, d, R2))) return Decision::yes;
  any.add(point_near_segment(t.b - s.a, d, R2));
  return any.result();
}

}  // namespace collided::engine::kernel
