#pragma once

#include <array>
#include <span>

#include "server/exact_phase/round_solids/exact_solid.hpp"

namespace collided::engine::kernel {

// Cylinders and cones against the features of a polytope, over any number type. If such a solid meets a polytope, it
// meets an edge; or, if none, it cuts a face strictly inside its rim; or, if none, it lies within the polytope.

/// A cylinder with its axis starting at the origin, or a cone with its apex there.
template <class N>
struct AxialSolid {
  Vector<N> axis;
  N length2;
  N radius;
  bool tapers;

  explicit AxialSolid(const Convex& set)
      : axis(Vector<N>(set.carrier[1]) - Vector<N>(set.carrier[0])),
        length2(square(axis)),
        radius(set.disc_m),
        tapers(set.first_disc > 0) {}
  explicit AxialSolid(const ExactSolid& set) requires std::same_as<N, Dyadic>
      : axis(set.axis()), length2(square(axis)), radius(set.radius), tapers(set.tapers()) {}
};

/// A point's position relative to the axis: its component along it, and its cross product with it, which is the
/// perpendicular part times the axis' length.
template <class N>
struct AboutAxis {
  N along;
  Vector<N> across;

  AboutAxis(const AxialSolid<N>& solid, const Vector<N>& point)
      : along(dot(point, solid.axis)), across(cross(point, solid.axis)) {}
};

/// A bilinear form of two points that, for one point twice, is >= 0 within the side: (R l)^2 - |across|^2 for a
/// cylinder, (R along)^2 - l^2 |across|^2 for a cone.
template <class N>
N side_form(const AxialSolid<N>& solid, const AboutAxis<N>& p, const AboutAxis<N>& q) {
  const N summand = dot(p.across, q.across);
  if (!solid.tapers) return solid.radius * solid.radius * solid.length2 - summand;
  return solid.radius * p.along * (solid.radius * q.along) - solid.length2 * summand;
}

/// A point of a segment by weights of its two ends: not negative, and not normalised.
template <class N>
struct SegmentWeights {
  N first;
  N second;
};

/// The part of a segment between the planes through the ends of the axis.
template <class N>
struct Clip {
  Decision is_any = Decision::yes;
  SegmentWeights<N> low{N(1.0), N(0.0)};
  SegmentWeights<N> high{N(0.0), N(1.0)};

  /// p and q: how far the segment's ends are behind a plane; drops the part in front of it.
  void keep_behind(const N& p, const N& q) {
    if (is_any != Decision::yes) return;
    // Distances of the ends of the remaining part.
    const N at_low = low.first * p + low.second * q;
    const N at_high = high.first * p + high.second * q;
    const Sign sign_low = sign(at_low);
    const Sign sign_high = sign(at_high);
    if (sign_low == Sign::unsure || sign_high == Sign::unsure) is_any = Decision::undecided;
    else if (sign_low == Sign::negative && sign_high == Sign::negative) is_any = Decision::no;
    if (is_any != Decision::yes || (sign_low != Sign::negative && sign_high != Sign::negative)) return;
    const N for_low = abs(at_high);
    const N for_high = abs(at_low);
    const SegmentWeights<N> crossing{for_low * low.first + for_high * high.first,
                                     for_low * low.second + for_high * high.second};
    (sign_low == Sign::negative ? low : high) = crossing;
  }
};

/// Whether the solid and a segment, both closed, share a point. A segment of length 0 is a point.
template <class N>
Decision meets_edge(const AxialSolid<N>& solid, const Vector<N>& p, const Vector<N>& q) {
  const AboutAxis<N> at_p(solid, p);
  const AboutAxis<N> at_q(solid, q);
  Clip<N> clip;
  clip.keep_behind(at_p.along, at_q.along);
  clip.keep_behind(solid.length2 - at_p.along, solid.length2 - at_q.along);
  if (clip.is_any != Decision::yes) return clip.is_any;
  const N pp = side_form(solid, at_p, at_p);
  const N pq = side_form(solid, at_p, at_q);
  const N qq = side_form(solid, at_q, at_q);
  const auto form = [&](const SegmentWeights<N>& s, const SegmentWeights<N>& t) {
    return s.first * t.first * pp + (s.first * t.second + s.second * t.first) * pq + s.second * t.second * qq;
  };
  const N low = form(clip.low, clip.low);
  const N high = form(clip.high, clip.high);
  const N mixed = form(clip.low, clip.high);
  // Within the side at an end of the remaining part, or between the ends: somewhere s^2 low + 2 s t mixed + t^2 high >=
  // 0.
  AnyOf any;
  any.add(opposite(is_positive(-low)));
  if (any.result() != Decision::yes) any.add(opposite(is_positive(-high)));
  if (any.result() != Decision::yes) any.add(both(is_positive(mixed), at_most(low * high, mixed * mixed)));
  return any.result();
}

/// A point as numerators over one positive divisor.
template <class N>
struct Quotient {
  Vector<N> numerator;
  N divisor;
};

/// A point that the solid shares with the plane through `on` with normal n. No: they share none. Unless an edge meets
/// the solid, everything that they share lies on one side of it, so this point represents all.
template <class N>
Decision point_on_plane(const AxialSolid<N>& solid, const Vector<N>& n, const Vector<N>& on, Quotient<N>& point) {
  const N at_from = -dot(n, on);
  const N rise = dot(n, solid.axis);
  const N at_end = at_from + rise;
  const Sign sign_from = sign(at_from);
  const Sign sign_end = sign(at_end);
  if (sign_from == Sign::unsure || sign_end == Sign::unsure) return Decision::undecided;
  if (sign_from == Sign::zero) {
    point = {Vector<N>(N(0.0), N(0.0), N(0.0)), N(1.0)};
    return Decision::yes;
  }
  if (sign_from != sign_end) {
    point = {abs(at_from) * solid.axis, abs(at_from) + abs(at_end)};
    return Decision::yes;
  }
  // The disc whose centre is nearer to the plane, and the point of it nearest to that centre.
  bool is_end = solid.tapers;
  if (!solid.tapers) {
    const Decision is_nearer = less(abs(at_end), abs(at_from));
    if (is_nearer == Decision::undecided) return is_nearer;
    is_end = is_nearer == Decision::yes;
  }
  const N& height = is_end ? at_end : at_from;
  const N slope = solid.length2 * square(n) - rise * rise;
  AllOf reaches;
  if (reaches.add(is_positive(slope))) return Decision::no;
  if (reaches.add(at_most(height * height * solid.length2, solid.radius * solid.radius * slope))) return Decision::no;
  const Vector<N> down = solid.length2 * n - rise * solid.axis;
  const Vector<N> middle = is_end ? slope * solid.axis : Vector<N>(N(0.0), N(0.0), N(0.0));
  point = {middle - height * down, slope};
  return reaches.result();
}

/// Whether the solid cuts the flat convex polygon; it must meet none of its edges.
template <class N>
Decision cuts_face(const AxialSolid<N>& solid, std::span<const Vector<N>> corner) {
  const Vector<N> n = cross(corner[1] - corner[0], corner[2] - corner[1]);
  // A polygon without area consists of its edges.
  if (sign(n.x) == Sign::zero && sign(n.y) == Sign::zero && sign(n.z) == Sign::zero) return Decision::no;
  Quotient<N> point;
  AllOf all;
  if (all.add(point_on_plane(solid, n, corner[0], point))) return Decision::no;
  if (all.result() == Decision::undecided) return Decision::undecided;
  for (std::size_t i = 0; i < corner.size(); ++i) {
    const Vector<N> edge = corner[(i + 1) % corner.size()] - corner[i];
    const N summand = dot(cross(n, edge), point.numerator - point.divisor * corner[i]);
    if (all.add(opposite(is_positive(-summand)))) return Decision::no;
  }
  return all.result();
}

}  // namespace collided::engine::kernel
