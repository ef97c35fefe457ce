#include "server/exact_phase/distance/polytope_kernel.hpp"

#include <algorithm>
#include <vector>

#include "server/exact_phase/distance/simplex_faces.hpp"

namespace collided::engine::kernel {
namespace {

using Point = Vector<Dyadic>;

/// The index of the corner farthest along n.
std::size_t farthest(const std::vector<Point>& corners, const Point& n) {
  std::size_t best = 0;
  Dyadic most = dot(n, corners[0]);
  for (std::size_t i = 1; i < corners.size(); ++i) {
    Dyadic along = dot(n, corners[i]);
    if ((along - most).sign() <= 0) continue;
    best = i;
    most = std::move(along);
  }
  return best;
}

bool is_origin(const Point& p) { return p.x.sign() == 0 && p.y.sign() == 0 && p.z.sign() == 0; }

/// Whether the hulls' distance is at most the sum of the balls' radii; if so, `foot` is that near.
Decision search(const std::vector<Point>& of_a, const std::vector<Point>& of_b, const Dyadic& ball,
                Foot<Dyadic>& foot) {
  for (const std::vector<Point>* corners : {&of_a, &of_b}) {
    for (const Point& p : *corners) {
      if (!p.x.finite() || !p.y.finite() || !p.z.finite()) return Decision::undecided;
    }
  }
  const auto difference = [&](std::size_t i, std::size_t j) {
    return MinkowskiVertex<Dyadic>{of_a[i] - of_b[j], i, j};
  };
  std::vector<MinkowskiVertex<Dyadic>> simplex{difference(0, 0)};
  while (nearest_of(simplex, foot)) {
    if (is_origin(foot.sum)) return Decision::yes;
    const MinkowskiVertex<Dyadic> next = difference(farthest(of_a, -foot.sum), farthest(of_b, foot.sum));
    const Dyadic level = square(foot.sum);
    const Dyadic along = dot(foot.sum, next.w) * foot.total;
    if (ball.sign() == 0 && along.sign() > 0) return Decision::no;
    if ((along - level).sign() >= 0) return at_most(level, ball * ball * (foot.total * foot.total));
    simplex = std::move(foot.corners);
    simplex.push_back(next);
  }
  return Decision::undecided;
}

}  // namespace

std::vector<Point> corners_of(const Convex& set) {
  std::vector<Point> corners;
  for (int i = 0; i < set.count(); ++i) corners.emplace_back(set.point(i));
  if (set.plus != Convex::Plus::box) return corners;
  Point reach[3];
  for (int i = 0; i < 3; ++i) reach[i] = Dyadic(set.half_m[i]) * Point(Vec3(set.axes.col(i)));
  const Point center = corners[0];
  corners.clear();
  for (int which = 0; which < 8; ++which) {
    Point corner = center;
    for (int i = 0; i < 3; ++i) corner = which >> i & 1 ? corner + reach[i] : corner - reach[i];
    corners.push_back(std::move(corner));
  }
  return corners;
}

std::vector<Point> corners_swept(const Convex& set, const Point& displacement) {
  std::vector<Point> corners = corners_of(set);
  const std::size_t count = corners.size();
  for (std::size_t i = 0; i < count; ++i) corners.push_back(corners[i] + displacement);
  return corners;
}

Decision polytopes_meet_on_motion(const Convex& a, const Convex& b, const StraightMotion& motion) {
  Foot<Dyadic> foot;
  return search(corners_swept(a, motion.displacement<Dyadic>()), corners_of(b), Dyadic(a.ball_m) + Dyadic(b.ball_m),
                foot);
}

Decision polytopes_meet(const Convex& a, const Convex& b) {
  Foot<Dyadic> foot;
  return search(corners_of(a), corners_of(b), Dyadic(a.ball_m) + Dyadic(b.ball_m), foot);
}

Decision hulls_meet(const std::vector<Point>& a, const std::vector<Point>& b, const Dyadic& radius_m) {
  Foot<Dyadic> foot;
  return search(a, b, radius_m, foot);
}

Decision hull_meets_ball(const std::vector<Vector<Dyadic>>& points, const Dyadic& radius_m) {
  Foot<Dyadic> foot;
  return search(points, {Point(Vec3(Vec3::Zero()))}, radius_m, foot);
}

std::optional<CommonPoint> common_point(const Convex& a, const Convex& b) {
  const std::vector<Point> of_a = corners_of(a);
  const std::vector<Point> of_b = corners_of(b);
  Foot<Dyadic> foot;
  if (search(of_a, of_b, Dyadic(a.ball_m) + Dyadic(b.ball_m), foot) != Decision::yes) return std::nullopt;
  // The point between a's hull and b's that divides the gap in proportion to the balls; without balls, the hulls'
  // common point.
  const bool no_balls = a.ball_m == 0 && b.ball_m == 0;
  const Dyadic share_a = no_balls ? Dyadic(1.0) : Dyadic(b.ball_m);
  const Dyadic share_b = no_balls ? Dyadic() : Dyadic(a.ball_m);
  CommonPoint common{.point = Point(Vec3(Vec3::Zero())), .divisor = foot.total * (share_a + share_b)};
  for (std::size_t i = 0; i < foot.corners.size(); ++i) {
    const MinkowskiVertex<Dyadic>& corner = foot.corners[i];
    const Dyadic& weight = foot.weights[i];
    common.point = common.point + weight * (share_a * of_a[corner.of_a] + share_b * of_b[corner.of_b]);
    common.mix_a.emplace_back(static_cast<std::uint32_t>(corner.of_a), weight);
    common.mix_b.emplace_back(static_cast<std::uint32_t>(corner.of_b), weight);
  }
  return common;
}

}  // namespace collided::engine::kernel
