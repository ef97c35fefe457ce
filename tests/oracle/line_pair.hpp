#pragma once

#include <array>

namespace collided::oracle {

/// How two lines lie to each other. A line is a point and a direction that is not zero.
enum class LineCase { crossing, skew, parallel, collinear };

/// Two lines: where they cross or are nearest, as first + s direction and second + t direction. Parallel and collinear
/// lines have no such place: s and t are 0. Over doubles or rationals.
template <class Number>
struct LinePair {
  LineCase kind = LineCase::crossing;
  Number s = 0;
  Number t = 0;
};

template <class Number>
using Point2 = std::array<Number, 2>;
template <class Number>
using Point3 = std::array<Number, 3>;

template <class Number>
Number perp_dot(const Point2<Number>& a, const Point2<Number>& b) {
  return a[0] * b[1] - a[1] * b[0];
}
template <class Number>
Number dot(const Point3<Number>& a, const Point3<Number>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class Number>
Point3<Number> cross(const Point3<Number>& a, const Point3<Number>& b) {
  return {Number(a[1] * b[2] - a[2] * b[1]), Number(a[2] * b[0] - a[0] * b[2]), Number(a[0] * b[1] - a[1] * b[0])};
}

/// In the plane, by perp dot products: those with the other direction cancel one unknown each.
template <class Number>
LinePair<Number> line_pair(const Point2<Number>& o1, const Point2<Number>& d1, const Point2<Number>& o2,
                           const Point2<Number>& d2) {
  const Point2<Number> between{Number(o2[0] - o1[0]), Number(o2[1] - o1[1])};
  const Number turn = perp_dot(d1, d2);
  if (turn == 0) return {perp_dot(between, d1) == 0 ? LineCase::collinear : LineCase::parallel};
  return {LineCase::crossing, Number(perp_dot(between, d2) / turn), Number(perp_dot(between, d1) / turn)};
}

/// In space: the segment between the nearest points is along the cross product of the directions.
/// source  Goldman, "Intersection of Two Lines in Three-Space", Graphics Gems, 1990
template <class Number>
LinePair<Number> line_pair(const Point3<Number>& o1, const Point3<Number>& d1, const Point3<Number>& o2,
                           const Point3<Number>& d2) {
  const Point3<Number> between{Number(o2[0] - o1[0]), Number(o2[1] - o1[1]), Number(o2[2] - o1[2])};
  const Point3<Number> normal = cross(d1, d2);
  const Number size2 = dot(normal, normal);
  if (size2 == 0) {
    const Point3<Number> aside = cross(between, d1);
    return {dot(aside, aside) == 0 ? LineCase::collinear : LineCase::parallel};
  }
  return {dot(between, normal) == 0 ? LineCase::crossing : LineCase::skew,
          Number(dot(cross(between, d2), normal) / size2), Number(dot(cross(between, d1), normal) / size2)};
}

}  // namespace collided::oracle
