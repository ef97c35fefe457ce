#pragma once

#include <array>

#include "server/exact_phase/kernels/triangle_kernel.hpp"

namespace collided::engine::kernel {

/// A box as the parallelepiped that its doubles describe; nothing here assumes perpendicular or unit axes.
template <class N>
struct Solid {
  Vector<N> center;
  std::array<Vector<N>, 3> axis;
  std::array<Vector<N>, 3> reach;   // half * axis: from the centre to the middle of a face
  std::array<Vector<N>, 3> normal;  // face normals: cross product of the other two axes
  std::array<N, 3> half;
  std::array<N, 3> height;  // |normal . reach|, the largest |normal . (x - center)| inside
  Sign volume;              // zero: the axes do not span space, and no test here decides

  explicit Solid(const Box& box) : center(box.center) {
    for (int i = 0; i < 3; ++i) {
      axis[i] = Vector<N>(Vec3(box.axes.col(i)));
      half[i] = N(box.half_m[i]);
      reach[i] = half[i] * axis[i];
    }
    for (int i = 0; i < 3; ++i) normal[i] = cross(axis[(i + 1) % 3], axis[(i + 2) % 3]);
    const N determinant = dot(axis[0], normal[0]);
    volume = sign(determinant);
    for (int i = 0; i < 3; ++i) height[i] = half[i] * abs(determinant);
  }

  bool spans() const { return volume == Sign::negative || volume == Sign::positive; }

  /// One of the four edges along axis k (bits 0 and 1 of `which`), relative to the centre.
  Segment<N> edge(int k, int which) const {
    const Vector<N>& u = reach[(k + 1) % 3];
    const Vector<N>& v = reach[(k + 2) % 3];
    const Vector<N> side_u = which & 1 ? u : -u;
    const Vector<N> middle = which & 2 ? side_u + v : side_u - v;
    return {middle - reach[k], middle + reach[k], reach[k] + reach[k]};
  }
};

/// In this and the functions below, w is relative to the centre.
template <class N>
Decision point_in_solid(const Vector<N>& w, const Solid<N>& box) {
  AllOf all;
  for (int i = 0; i < 3 && all.result() != Decision::no; ++i) {
    all.add(at_most(abs(dot(w, box.normal[i])), box.height[i]));
  }
  return all.result();
}

/// Whether the point stands over face i on the face's outer side, within R of its plane.
template <class N>
Decision point_near_solid_face(const Vector<N>& w, const Solid<N>& box, int i, const N& R2) {
  const Vector<N>& n = box.normal[i];
  const N along = dot(w, n);
  const N above = abs(along) - box.height[i];
  const N nn = square(n);
  AllOf all;
  if (all.add(is_positive(above)) || all.add(at_most(above * above, R2 * nn))) return Decision::no;
  const Sign side = sign(dot(box.axis[i], n));
  const Sign point_side = sign(along);
  if (side == Sign::unsure || point_side == Sign::unsure) return Decision::undecided;
  const Vector<N> from_face = side == point_side ? w - box.reach[i] : w + box.reach[i];
  const int j = (i + 1) % 3;
  const int k = (i + 2) % 3;
  // Coordinates of the foot along the face's two axes, times n . n.
  all.add(at_most(abs(dot(from_face, cross(box.axis[k], n))), box.half[j] * nn));
  all.add(at_most(abs(dot(from_face, cross(n, box.axis[j]))), box.half[k] * nn));
  return all.result();
}

/// Whether the whole segment w0 w1 is beyond a face's plane, farther than R.
template <class N>
bool face_keeps_away(const Vector<N>& w0, const Vector<N>& w1, const Solid<N>& box, const N& R2) {
  for (int i = 0; i < 3; ++i) {
    const N p = dot(w0, box.normal[i]);
    const N q = dot(w1, box.normal[i]);
    const N above = max(min(p, q), -max(p, q)) - box.height[i];
    if (sign(above) == Sign::positive && less(R2 * square(box.normal[i]), above * above) == Decision::yes) return true;
  }
  return false;
}

/// Whether the point is within R of the box.
template <class N>
Decision point_near_solid(const Vector<N>& w, const Solid<N>& box, const N& R2) {
  if (!box.spans()) return Decision::undecided;
  if (face_keeps_away(w, w, box, R2)) return Decision::no;
  AnyOf any;
  if (any.add(point_in_solid(w, box))) return Decision::yes;
  for (int i = 0; i < 3; ++i) {
    if (any.add(point_near_solid_face(w, box, i, R2))) return Decision::yes;
  }
  for (int edge = 0; edge < 12; ++edge) {
    if (any.add(point_near_segment(w, box.edge(edge / 4, edge % 4), R2))) return Decision::yes;
  }
  return any.result();
}

/// A body for tests of separating axes: the hull of up to three points, plus the extent of a box.
template <class N>
struct Body {
  std::array<Vector<N>, 3> point;
  int point_count = 0;
  std::array<Vector<N>, 3> direction;  // directions of all edges
  int direction_count = 0;
  const Solid<N>* box = nullptr;

  explicit Body(const Solid<N>& b) : point{b.center}, point_count(1), direction(b.axis), direction_count(3), box(&b) {}
  explicit Body(const Facet<N>& f) : point(f.corner), point_count(3), direction(f.edge), direction_count(3) {}
  explicit Body(const Segment<N>& s) : point{s.a, s.b}, point_count(2), direction{s.d}, direction_count(1) {}
};

/// Whether planes perpendicular to n separate the two: the gap between the projections is positive.
template <class N>
Decision separates(const Vector<N>& n, const Body<N>& a, const Body<N>& b) {
  N reach(0.0);
  for (const Body<N>* body : {&a, &b}) {
    if (!body->box) continue;
    for (int i = 0; i < 3; ++i) reach = reach + body->box->half[i] * abs(dot(n, body->box->axis[i]));
  }
  // Takes differences of the points first, so that errors scale with the pair's size.
  N nearest = dot(n, b.point[0] - a.point[0]);
  N farthest = nearest;
  for (int i = 0; i < a.point_count; ++i) {
    for (int j = 0; j < b.point_count; ++j) {
      if (i + j == 0) continue;
      const N along = dot(n, b.point[j] - a.point[i]);
      nearest = min(nearest, along);
      farthest = max(farthest, along);
    }
  }
  return either(less(reach, nearest), less(reach, -farthest));
}

/// Whether two axes are exactly equal or opposite: their cross product is zero, which rounding hides from a running
/// error bound.
template <class N>
bool same_line(const Vector<N>&, const Vector<N>&) {
  return false;
}
template <Rounding N>
bool same_line(const Vector<N>& a, const Vector<N>& b) {
  if (a.x.error + a.y.error + a.z.error + b.x.error + b.y.error + b.z.error != 0) return false;
  const auto equal = [&](double s) {
    return a.x.value == s * b.x.value && a.y.value == s * b.y.value && a.z.value == s * b.z.value;
  };
  return equal(1) || equal(-1);
}

/// Separating axes: the face normals of both and the cross products of their edges (Gottschalk, Lin, Manocha,
/// "OBBTree", 1996). Complete because one of the two is a box: the Minkowski difference is then full-dimensional, even
/// for boxes of size zero (as a limit of small ones) and degenerate triangles.
template <class N>
Decision bodies_meet(const Body<N>& a, const Body<N>& b) {
  AllOf together;
  for (const Body<N>* body : {&a, &b}) {
    if (body->box) {
      if (!body->box->spans()) return Decision::undecided;
      for (int i = 0; i < 3; ++i) {
        if (together.add(opposite(separates(body->box->normal[i], a, b)))) return Decision::no;
      }
    } else if (body->point_count == 3) {
      const Vector<N> n = cross(body->direction[0], body->direction[1]);
      if (together.add(opposite(separates(n, a, b)))) return Decision::no;
    }
  }
  for (int i = 0; i < a.direction_count; ++i) {
    for (int j = 0; j < b.direction_count; ++j) {
      if (same_line(a.direction[i], b.direction[j])) continue;
      if (together.add(opposite(separates(cross(a.direction[i], b.direction[j]), a, b)))) return Decision::no;
    }
  }
  return together.result();
}

/// Whether the segment comes within R of the box.
template <class N>
Decision segment_near_solid(const Segment<N>& s, const Solid<N>& box, const N& R2) {
  if (!box.spans()) return Decision::undecided;
  const Segment<N> local{s.a - box.center, s.b - box.center, s.d};
  if (face_keeps_away(local.a, local.b, box, R2)) return Decision::no;
  AnyOf any;
  if (any.add(point_in_solid(local.a, box)) || any.add(point_in_solid(local.b, box))) return Decision::yes;
  for (int i = 0; i < 3; ++i) {
    if (any.add(point_near_solid_face(local.a, box, i, R2))) return Decision::yes;
    if (any.add(point_near_solid_face(local.b, box, i, R2))) return Decision::yes;
  }
  for (int edge = 0; edge < 12; ++edge) {
    if (any.add(segments_near(local, box.edge(edge / 4, edge % 4), R2))) return Decision::yes;
  }
  any.add(bodies_meet(Body<N>(box), Body<N>(s)));
  return any.result();
}

}  // namespace collided::engine::kernel
