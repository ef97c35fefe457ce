#pragma once

#include <array>

#include "server/exact_phase/kernels/segment_kernel.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// A triangle with its edges and normal, computed once.
template <class N>
struct Facet {
  std::array<Vector<N>, 3> corner;
  std::array<Vector<N>, 3> edge;  // edge i runs from corner i to corner i + 1
  Vector<N> normal;

  Facet(Vector<N> a, Vector<N> b, Vector<N> c)
      : corner{std::move(a), std::move(b), std::move(c)},
        edge{corner[1] - corner[0], corner[2] - corner[1], corner[0] - corner[2]},
        normal(cross(edge[0], edge[1])) {}
  explicit Facet(const Triangle& t) : Facet(Vector<N>(t.a), Vector<N>(t.b), Vector<N>(t.c)) {}

  Segment<N> side(int i) const { return {corner[i], corner[(i + 1) % 3], edge[i]}; }
};

/// Whether the point stands strictly over the facet's interior; `near_plane` states whether it is within R of the
/// plane.
template <class N>
Decision point_near_face(const Vector<N>& p, const Facet<N>& f, Decision near_plane) {
  AllOf all;
  all.add(near_plane);
  for (int i = 0; i < 3 && all.result() != Decision::no; ++i) {
    all.add(is_positive(dot(cross(f.normal, f.edge[i]), p - f.corner[i])));
  }
  return all.result();
}

template <class N>
Decision point_near_facet(const Vector<N>& p, const Facet<N>& f, const N& R2) {
  const N height = dot(f.normal, p - f.corner[0]);
  const Decision near_plane = at_most(height * height, R2 * square(f.normal));
  if (near_plane == Decision::no) return Decision::no;
  AnyOf any;
  if (any.add(point_near_face(p, f, near_plane))) return Decision::yes;
  for (int i = 0; i < 3; ++i) {
    if (any.add(point_near_segment(p - f.corner[i], f.edge[i], R2))) return Decision::yes;
  }
  return any.result();
}

/// The axis to drop for a projection: one along which n is certainly not zero; -1 if uncertain, 3 if n is zero.
template <class N>
int dropped_axis(const Vector<N>& n) {
  bool unsure = false;
  const std::array<const N*, 3> component{&n.x, &n.y, &n.z};
  for (int k = 0; k < 3; ++k) {
    const Sign s = sign(*component[k]);
    if (s == Sign::unsure) unsure = true;
    else if (s != Sign::zero) return k;
  }
  return unsure ? -1 : 3;
}

/// The sign of one component of the cross product of (b - a) and (c - a).
template <class N>
Sign turn(const Vector<N>& a, const Vector<N>& b, const Vector<N>& c, int axis) {
  if (axis == 0) return sign((b.y - a.y) * (c.z - a.z) - (b.z - a.z) * (c.y - a.y));
  if (axis == 1) return sign((b.z - a.z) * (c.x - a.x) - (b.x - a.x) * (c.z - a.z));
  return sign((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}

/// Whether the ranges [a, b] and [c, d], their ends in either order, share a number.
template <class N>
Decision ranges_meet(const N& a, const N& b, const N& c, const N& d) {
  return both(at_most(min(a, b), max(c, d)), at_most(min(c, d), max(a, b)));
}

template <class N>
Decision boxes_meet(const Segment<N>& s, const Segment<N>& t) {
  AllOf all;
  if (all.add(ranges_meet(s.a.x, s.b.x, t.a.x, t.b.x))) return Decision::no;
  if (all.add(ranges_meet(s.a.y, s.b.y, t.a.y, t.b.y))) return Decision::no;
  all.add(ranges_meet(s.a.z, s.b.z, t.a.z, t.b.z));
  return all.result();
}

template <class N>
Decision is_zero(const Vector<N>& v) {
  AllOf all;
  all.add(is_zero(v.x));
  all.add(is_zero(v.y));
  all.add(is_zero(v.z));
  return all.result();
}

/// Whether two closed segments in space, each possibly a point, meet.
template <class N>
Decision segments_meet(const Segment<N>& s, const Segment<N>& t) {
  const Decision boxes = boxes_meet(s, t);
  if (boxes == Decision::no) return boxes;
  const Vector<N>& d = s.d;
  const Vector<N>& e = t.d;
  const Vector<N> w = t.a - s.a;
  const Vector<N> n = cross(d, e);
  const int axis = dropped_axis(n);
  if (axis < 0) return Decision::undecided;
  if (axis == 3) {
    // Parallel, or one a point: on a common line the coordinate ranges decide.
    return both(both(is_zero(cross(w, d)), is_zero(cross(w, e))), boxes);
  }
  const Decision coplanar = is_zero(dot(w, n));
  if (coplanar == Decision::no) return coplanar;
  const auto straddles = [axis](const Segment<N>& line, const Segment<N>& ends) {
    const Sign a = turn(line.a, line.b, ends.a, axis);
    const Sign b = turn(line.a, line.b, ends.b, axis);
    if (a == Sign::unsure || b == Sign::unsure) return Decision::undecided;
    return static_cast<int>(a) * static_cast<int>(b) <= 0 ? Decision::yes : Decision::no;
  };
  return both(coplanar, both(straddles(s, t), straddles(t, s)));
}

/// Whether a point in the plane of a facet is inside or on the border; the facet's normal must have a non-zero
/// component `axis`.
template <class N>
Decision point_in_facet(const Vector<N>& p, const Facet<N>& f, int axis) {
  bool negative = false;
  bool positive = false;
  for (int i = 0; i < 3; ++i) {
    const Sign s = turn(f.corner[i], f.corner[(i + 1) % 3], p, axis);
    if (s == Sign::unsure) return Decision::undecided;
    negative = negative || s == Sign::negative;
    positive = positive || s == Sign::positive;
  }
  return negative && positive ? Decision::no : Decision::yes;
}

template <class N>
Decision flat_segment_meets_facet(const Segment<N>& s, const Facet<N>& f, int axis) {
  AnyOf any;
  if (any.add(point_in_facet(s.a, f, axis))) return Decision::yes;
  for (int i = 0; i < 3; ++i) {
    if (any.add(segments_meet(s, f.side(i)))) return Decision::yes;
  }
  return any.result();
}

/// Whether the line through s passes the facet's three edges on the same side, touching included. s must not be
/// parallel to the facet.
template <class N>
Decision line_pierces_facet(const Segment<N>& s, const Facet<N>& f) {
  bool negative = false;
  bool positive = false;
  bool unsure = false;
  const Vector<N>& d = s.d;
  for (int i = 0; i < 3; ++i) {
    const Sign side = sign(dot(f.edge[i], cross(f.corner[i] - s.a, d)));
    unsure = unsure || side == Sign::unsure;
    negative = negative || side == Sign::negative;
    positive = positive || side == Sign::positive;
  }
  if (negative && positive) return Decision::no;
  return unsure ? Decision::undecided : Decision::yes;
}

/// The side of the facet's plane on which a point is.
template <class N>
Sign plane_side(const Vector<N>& p, const Facet<N>& f) {
  return sign(dot(f.normal, p - f.corner[0]));
}

/// Whether a closed segment (possibly a point) meets a closed triangle (possibly a segment or a point), given the sides
/// of the segment's ends.
template <class N>
Decision segment_meets_facet(const Segment<N>& s, const Facet<N>& f, Sign a, Sign b) {
  if ((a == Sign::positive && b == Sign::positive) || (a == Sign::negative && b == Sign::negative)) return Decision::no;
  if (a == Sign::unsure || b == Sign::unsure) {
    // If it is uncertain whether the plane is reached, a line that certainly misses the triangle still decides. If the
    // two lie in one plane, all three sides are zero, so they never have both signs.
    return line_pierces_facet(s, f) == Decision::no ? Decision::no : Decision::undecided;
  }
  if (a != Sign::zero || b != Sign::zero) return line_pierces_facet(s, f);
  const int axis = dropped_axis(f.normal);
  if (axis < 0) return Decision::undecided;
  if (axis < 3) return flat_segment_meets_facet(s, f, axis);
  AnyOf any;
  for (int i = 0; i < 3; ++i) {
    if (any.add(segments_meet(s, f.side(i)))) return Decision::yes;
  }
  return any.result();
}

template <class N>
Decision segment_meets_facet(const Segment<N>& s, const Facet<N>& f) {
  return segment_meets_facet(s, f, plane_side(s.a, f), plane_side(s.b, f));
}

/// The sides of a plane on which three corners are.
using SideSigns = std::array<Sign, 3>;

template <class N>
SideSigns plane_sides(const Facet<N>& points, const Facet<N>& plane) {
  return {plane_side(points.corner[0], plane), plane_side(points.corner[1], plane),
          plane_side(points.corner[2], plane)};
}

inline bool all_on_one_side(const SideSigns& s) {
  return s[0] == s[1] && s[1] == s[2] && (s[0] == Sign::positive || s[0] == Sign::negative);
}

/// Two triangles meet exactly when an edge of one meets the other.
template <class N>
Decision facets_meet(const Facet<N>& f, const Facet<N>& g) {
  const SideSigns g_about_f = plane_sides(g, f);
  if (all_on_one_side(g_about_f)) return Decision::no;
  const SideSigns f_about_g = plane_sides(f, g);
  if (all_on_one_side(f_about_g)) return Decision::no;
  AnyOf any;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    if (any.add(segment_meets_facet(f.side(i), g, f_about_g[i], f_about_g[j]))) return Decision::yes;
    if (any.add(segment_meets_facet(g.side(i), f, g_about_f[i], g_about_f[j]))) return Decision::yes;
  }
  return any.result();
}

template <class N>
Decision segment_near_facet(const Segment<N>& s, const Facet<N>& f, const N& R2) {
  const N height_a = dot(f.normal, s.a - f.corner[0]);
  const N height_b = dot(f.normal, s.b - f.corner[0]);
  const N limit = R2 * square(f.normal);
  const Decision a_near = at_most(height_a * height_a, limit);
  const Decision b_near = at_most(height_b * height_b, limit);
  const Sign side = sign(height_a);
  const bool one_side = side == sign(height_b) && side != Sign::unsure;
  if (one_side && a_near == Decision::no && b_near == Decision::no) return Decision::no;
  AnyOf any;
  if (any.add(point_near_face(s.a, f, a_near))) return Decision::yes;
  if (any.add(point_near_face(s.b, f, b_near))) return Decision::yes;
  for (int i = 0; i < 3; ++i) {
    if (any.add(segments_near(s, f.side(i), R2))) return Decision::yes;
  }
  any.add(segment_meets_facet(s, f));
  return any.result();
}

}  // namespace collided::engine::kernel
