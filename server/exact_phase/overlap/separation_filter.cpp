#include "server/exact_phase/overlap/separation_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/plain_range.hpp"
#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/exact_phase/overlap/box_lanes.hpp"
#include "server/exact_phase/overlap/box_pair.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

using Triples = std::array<Triple, 3>;

/// Collects gaps (distance between projections minus the extents of the bodies), each with the error of its axis.
class AxisGaps {
 public:
  /// True: this axis certainly separates.
  bool add(double gap, double error) {
    unsure_ = unsure_ || !(gap < -error);
    return gap > error;
  }
  Decision together() const { return unsure_ ? Decision::undecided : Decision::yes; }

 private:
  bool unsure_ = false;
};

/// Products of four such lengths stay far from both ends of the range of double.
constexpr double kLongest_m = 0x1p100;
/// In this range overflow and underflow have no effect: a gap's bound is at least 2^-50 of a product of three lengths.
bool in_range(double length) { return length >= 1 / kLongest_m && length <= kLongest_m; }

}  // namespace

Decision quickly_overlaps(const Box& a, const Box& b, double off_m) {
  return overlap_in_lanes(a, b, gap_bounds(off_m));
}

Decision quickly_overlaps(const Box& a, const Triangle& b) {
  const BoxAxes frame(a);
  const Triple center = triple(a.center);
  const Triples corner{triple(b.a) - center, triple(b.b) - center, triple(b.c) - center};
  const Triples edge{triple(b.b) - triple(b.a), triple(b.c) - triple(b.b), triple(b.a) - triple(b.c)};
  const double side = std::max({edge[0].largest(), edge[1].largest(), edge[2].largest()});
  const double reach =
      std::max({corner[0].largest(), corner[1].largest(), corner[2].largest()}) + frame.largest * frame.half_sum;
  if (!in_range(frame.largest) || !in_range(side) || !in_range(reach)) return Decision::undecided;
  const double singular = kSeparationError * frame.largest * frame.largest * frame.largest;
  if (!(frame.volume > singular)) return Decision::undecided;

  AxisGaps gaps;
  const double face_error = kSeparationError * frame.largest * frame.largest * reach;
  bool inside[3] = {true, true, true};
  for (int i = 0; i < 3; ++i) {
    const double p[3] = {dot(corner[0], frame.normal[i]), dot(corner[1], frame.normal[i]),
                         dot(corner[2], frame.normal[i])};
    const double apart = std::max(std::min({p[0], p[1], p[2]}), -std::max({p[0], p[1], p[2]}));
    if (gaps.add(apart - a.half_m[i] * frame.volume, face_error)) return Decision::no;
    for (int k = 0; k < 3; ++k) inside[k] = inside[k] && std::abs(p[k]) - a.half_m[i] * frame.volume < -face_error;
  }
  // Most triangles that a box meets have a corner in it.
  if (inside[0] || inside[1] || inside[2]) return Decision::yes;
  const Triple normal = cross(edge[0], edge[1]);
  double reach_over = 0;
  for (int i = 0; i < 3; ++i) reach_over += a.half_m[i] * std::abs(dot(normal, frame.axis[i]));
  if (gaps.add(std::abs(dot(normal, corner[0])) - reach_over, kSeparationError * side * side * reach))
    return Decision::no;

  const double edge_error = kSeparationError * frame.largest * side * reach;
  for (int j = 0; j < 3; ++j) {
    // An edge projects to one number perpendicular to itself, the opposite corner to another.
    const Triple moment_edge = cross(edge[j], corner[j]);
    const Triple moment_opposite = cross(edge[j], corner[(j + 2) % 3]);
    const double over[3] = {std::abs(dot(edge[j], frame.normal[0])), std::abs(dot(edge[j], frame.normal[1])),
                            std::abs(dot(edge[j], frame.normal[2]))};
    for (int i = 0; i < 3; ++i) {
      const int i1 = (i + 1) % 3;
      const int i2 = (i + 2) % 3;
      const double p = dot(frame.axis[i], moment_edge);
      const double q = dot(frame.axis[i], moment_opposite);
      const double apart = std::max(std::min(p, q), -std::max(p, q));
      if (gaps.add(apart - (a.half_m[i1] * over[i2] + a.half_m[i2] * over[i1]), edge_error)) return Decision::no;
    }
  }
  return gaps.together();
}

double push_at_most(const Box& a, const Triangle& b, double& reach_m) {
  const BoxAxes frame(a);
  const Triple center = triple(a.center);
  const Triples corner{triple(b.a) - center, triple(b.b) - center, triple(b.c) - center};
  const double far = std::max({corner[0].largest(), corner[1].largest(), corner[2].largest()});
  const double reach = far + frame.largest * frame.half_sum;
  reach_m = 4 * reach;
  double least = std::numeric_limits<double>::infinity();
  if (!in_range(frame.largest) || !in_range(reach)) return least;
  const auto try_axis = [&](const Triple& axis) {
    const double p[3] = {dot(corner[0], axis), dot(corner[1], axis), dot(corner[2], axis)};
    double half = 0;
    for (int i = 0; i < 3; ++i) half += a.half_m[i] * std::abs(dot(frame.axis[i], axis));
    const double push = half + std::min(std::max({p[0], p[1], p[2]}), -std::min({p[0], p[1], p[2]}));
    const double length2 = dot(axis, axis);
    // Far above underflow; the error of the products is at most kSeparationError of A |axis| (D + A H).
    if (length2 >= 1 / kernel::kLargestPlain2)
      least = std::min(least, push / std::sqrt(length2) + 4 * kSeparationError * reach);
  };
  for (const Triple& normal : frame.normal) try_axis(normal);
  try_axis(cross(triple(b.b) - triple(b.a), triple(b.c) - triple(b.a)));
  return least;
}

namespace {

/// The sign if it is certain, else 0.
int sure_sign(double value, double error) { return value > error ? 1 : value < -error ? -1 : 0; }

/// The sides of a facet's plane on which three points are.
struct About {
  int side[3] = {0, 0, 0};
  double reach = 0;  // upper bound on the coordinates of all differences between the points and the facet's corners

  bool all_sure() const { return side[0] * side[1] * side[2] != 0; }
  bool one_sided() const { return side[0] == side[1] && side[1] == side[2] && side[0] != 0; }
  /// The corner alone on its side, if all sides are certain and differ.
  int lone() const { return side[0] == side[1] ? 2 : side[0] == side[2] ? 1 : 0; }
};

/// How much a triple product of differences of points changes if the points together move by off_m, relative to off_m
/// and the square of the largest coordinate: three factors change by 2 off_m each, and two others are at most sqrt(3)
/// times their largest coordinate (18); the rest covers the products of changes.
constexpr double kMovedProduct = 24;
constexpr double kLeastReachOverMove = 100;

About sides_about(const Triples& points, const Triples& plane, double off_m) {
  const Triple e = plane[1] - plane[0];
  const Triple f = plane[2] - plane[0];
  const Triple normal = cross(e, f);
  const Triples motion{points[0] - plane[0], points[1] - plane[0], points[2] - plane[0]};
  const double first = e.largest();
  const double second = f.largest();
  const double distance = std::max({motion[0].largest(), motion[1].largest(), motion[2].largest()});
  if (!in_range(first) || !in_range(second) || !in_range(distance)) return {};
  const double largest = std::max({first, second, distance});
  if (off_m * kLeastReachOverMove > largest) return {};
  const double error = kOrientationError * first * second * distance + kMovedProduct * off_m * largest * largest;
  return {{sure_sign(dot(normal, motion[0]), error), sure_sign(dot(normal, motion[1]), error),
           sure_sign(dot(normal, motion[2]), error)},
          (distance + std::max(first, second)) * (1 + kFewSlack)};
}

}  // namespace

Decision quickly_overlaps(const Triangle& a, const Triangle& b, double off_m) {
  const Triples s{triple(a.a), triple(a.b), triple(a.c)};
  const Triples t{triple(b.a), triple(b.b), triple(b.c)};
  const About s_about = sides_about(s, t, off_m);
  if (s_about.one_sided()) return Decision::no;
  const About t_about = sides_about(t, s, off_m);
  if (t_about.one_sided()) return Decision::no;
  if (!s_about.all_sure() || !t_about.all_sure()) return Decision::undecided;

  // Orients both so that the lone corner of each is above the other's plane: else that plane is flipped.
  const int i = s_about.lone();
  const int j = t_about.lone();
  const bool turn_t = s_about.side[i] < 0;
  const bool turn_s = t_about.side[j] < 0;
  const Triple& p = s[i];
  const Triple& p1 = s[(i + (turn_s ? 2 : 1)) % 3];
  const Triple& p2 = s[(i + (turn_s ? 1 : 2)) % 3];
  const Triple& q = t[j];
  const Triple& q1 = t[(j + (turn_t ? 2 : 1)) % 3];
  const Triple& q2 = t[(j + (turn_t ? 1 : 2)) % 3];
  // Two of each three factors lie between the triangles; the third is an edge of s, no longer than two edges that leave
  // its first corner.
  const double reach = std::max(s_about.reach, t_about.reach);
  const double error =
      2 * kOrientationError * s_about.reach * s_about.reach * t_about.reach + 2 * kMovedProduct * off_m * reach * reach;
  const double one = dot(q1 - p1, cross(q - p1, p - p1));
  const double other = dot(q2 - p, cross(q - p, p2 - p));
  if (one > error || other > error) return Decision::no;
  return one < -error && other < -error ? Decision::yes : Decision::undecided;
}

}  // namespace collided::engine::kernel
