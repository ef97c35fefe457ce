#pragma once

#include "server/exact_phase/arithmetic/number.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// A shape without its radius: the hull of up to three points, or a box.
struct Core {
  Vec3 point[3] = {Vec3::Zero(), Vec3::Zero(), Vec3::Zero()};
  int point_count = 1;
  bool is_box = false;
  Mat3 axes = Mat3::Zero();
  Vec3 half_m = Vec3::Zero();
  double span_m = 0;  // for a box: sum of the absolute coordinates of its half axes
  // of the ball around every point
  double radius_m = 0;

  explicit Core(const Sphere& s) : point{s.center}, radius_m(s.radius_m) {}
  explicit Core(const Box& b) : point{b.center}, is_box(true), axes(b.axes), half_m(b.half_m) { measure(); }
  explicit Core(const Capsule& c) : point{c.a, c.b}, point_count(2), radius_m(c.radius_m) {}
  explicit Core(const Triangle& t) : point{t.a, t.b, t.c}, point_count(3) {}

  /// Sets span_m; call it after axes or half_m changed.
  void measure() { span_m = (axes * half_m.asDiagonal()).cwiseAbs().sum(); }
};

/// An upper bound on the coordinates of its points.
double extent(const Core& core);

/// Multiplies every length by 2^power.
void scale(Core& core, int power);

/// The direction of an edge, to - from, stored as two points so that exact arithmetic can form the difference.
struct EdgeDirection {
  Vec3 to;
  Vec3 from;
};

/// The normal of a possible facet of two cores' Minkowski difference: the cross product of two edges.
struct FacetAxis {
  EdgeDirection u;
  EdgeDirection v;
};

/// All facet normals of the Minkowski difference, up to sign.
struct FacetAxes {
  FacetAxis axis[15];
  int count = 0;
};

FacetAxes facet_axes(const Core& a, const Core& b);
/// facet_axes(a, b).axis[number] of two boxes.
FacetAxis facet_axis_of_boxes(const Core& a, const Core& b, int number);

/// Products with exact numbers. In Bounded, operations without effect for such a factor are left out, which changes no
/// bit of a finite result.
template <class N>
N times(const N& x, double exact) {
  return N(exact) * x;
}
inline Bounded times(const Bounded& x, double exact) {
  const double value = x.value * exact;
  const double underflow = x.exactly_zero() || exact == 0 ? 0.0 : kUnderflow;
  return {value, (std::abs(exact) * x.error + kRoundoff * std::abs(value)) + underflow};
}
template <class N>
N along(const Vector<N>& n, const Vec3& exact) {
  return (times(n.x, exact[0]) + times(n.y, exact[1])) + times(n.z, exact[2]);
}

/// The facet's normal, of any length; zero if the edges are parallel.
template <class N>
Vector<N> direction(const FacetAxis& axis) {
  return cross(Vector<N>(axis.u.to) - Vector<N>(axis.u.from), Vector<N>(axis.v.to) - Vector<N>(axis.v.from));
}

/// How far b must move along n, and along -n, until the cores only touch; both times |n|. `forward` is the largest n .
/// (x_a - x_b).
template <class N>
struct Pushes {
  N forward;
  N backward;
};

/// Same, with the facet's normal n and its square.
template <class N>
struct FacetPush {
  Vector<N> n;
  N square;
  Pushes<N> push;
};

template <class N>
Pushes<N> pushes_along(const Vector<N>& n, const Core& a, const Core& b) {
  N largest = dot(n, Vector<N>(a.point[0]) - Vector<N>(b.point[0]));
  N smallest = largest;
  for (int pair = 1; pair < a.point_count * b.point_count; ++pair) {
    const N along = dot(n, Vector<N>(a.point[pair / b.point_count]) - Vector<N>(b.point[pair % b.point_count]));
    largest = max(largest, along);
    smallest = min(smallest, along);
  }
  N reach(0.0);
  for (const Core* core : {&a, &b}) {
    for (int i = 0; core->is_box && i < 3; ++i) {
      reach = reach + times(abs(along(n, core->axes.col(i))), core->half_m[i]);
    }
  }
  return {largest + reach, reach - smallest};
}

/// A point of both cores near the middle of their overlap, given that they do overlap. In plain double: it is where the
/// contact is drawn and its force applied; no decision depends on it.
Vec3 middle_of_both(const Core& a, const Core& b, const Vec3& normal);

/// Points of two cores at about the least distance, each on its core up to a few roundings of its extent. b must be a
/// point or a segment.
struct WitnessPair {
  Vec3 on_a = Vec3::Zero();
  Vec3 on_b = Vec3::Zero();
};
WitnessPair nearest_witnesses(const Core& a, const Core& b);

}  // namespace collided::engine::kernel
