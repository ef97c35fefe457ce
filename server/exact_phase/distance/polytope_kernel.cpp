#include "server/exact_phase/distance/polytope_kernel.hpp"

#include <algorithm>
#include <vector>

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

/// A corner of a minus one of b.
struct MinkowskiVertex {
  Point w;
  std::size_t of_a = 0;
  std::size_t of_b = 0;
};

/// The point nearest to the origin as sum / total, and its weights of the corners.
struct Foot {
  Point sum;
  Dyadic total;
  std::vector<MinkowskiVertex> corners;
  std::vector<Dyadic> weights;
};

/// The weights of the origin's foot on the plane, line or point through all corners; their sum is at least zero.
std::vector<Dyadic> weights_of(const std::vector<MinkowskiVertex>& corners) {
  if (corners.size() == 1) return {Dyadic(1.0)};
  std::vector<Point> w;
  for (const MinkowskiVertex& corner : corners) w.push_back(corner.w);
  if (w.size() == 2) return {dot(w[1], w[1] - w[0]), dot(w[0], w[0] - w[1])};
  const Point n = cross(w[1] - w[0], w[2] - w[0]);
  if (w.size() == 3) return {dot(n, cross(w[1], w[2])), dot(n, cross(w[2], w[0])), dot(n, cross(w[0], w[1]))};
  const Dyadic volume = dot(n, w[3] - w[0]);
  const Dyadic turn(volume.sign() < 0 ? -1.0 : 1.0);
  // Volumes of the tetrahedron with the origin in place of each corner.
  return {turn * dot(w[1], cross(w[2], w[3])), -turn * dot(w[0], cross(w[2], w[3])),
          turn * dot(w[0], cross(w[1], w[3])), -turn * dot(w[0], cross(w[1], w[2]))};
}

/// The point of the simplex nearest to the origin lies inside exactly one of its faces: the one for which no other
/// corner is nearer along the foot. Tests one face.
bool nearest_in(const std::vector<MinkowskiVertex>& simplex, unsigned which, Foot& foot) {
  std::vector<MinkowskiVertex> face;
  for (std::size_t i = 0; i < simplex.size(); ++i) {
    if (which >> i & 1) face.push_back(simplex[i]);
  }
  Foot found{Point(Vec3(Vec3::Zero())), Dyadic(), face, weights_of(face)};
  for (std::size_t i = 0; i < face.size(); ++i) {
    if (found.weights[i].sign() <= 0) return false;
    found.sum = found.sum + found.weights[i] * face[i].w;
    found.total = found.total + found.weights[i];
  }
  const Dyadic level = square(found.sum);
  for (const MinkowskiVertex& corner : simplex) {
    if ((dot(found.sum, corner.w) * found.total - level).sign() < 0) return false;
  }
  foot = std::move(found);
  return true;
}

bool nearest_of(const std::vector<MinkowskiVertex>& simplex, Foot& foot) {
  for (unsigned which = 1; which < 1u << simplex.size(); ++which) {
    if (nearest_in(simplex, which, foot)) return true;
  }
  return false;
}

bool is_origin(const Point& p) { return p.x.sign() == 0 && p.y.sign() == 0 && p.z.sign() == 0; }

/// Whether the hulls' distance is at most the sum of the balls' radii; if so, `foot` is that near.
Decision search(const std::vector<Point>& of_a, const std::vector<Point>& of_b, const Dyadic& ball, Foot& foot) {
  for (const std::vector<Point>* corners : {&of_a, &of_b}) {
    for (const Point& p : *corners) {
      if (!p.x.finite() || !p.y.finite() || !p.z.finite()) return Decision::undecided;
    }
  }
  const auto difference = [&](std::size_t i, std::size_t j) { return MinkowskiVertex{of_a[i] - of_b[j], i, j}; };
  std::vector<MinkowskiVertex> simplex{difference(0, 0)};
  while (nearest_of(simplex, foot)) {
    if (is_origin(foot.sum)) return Decision::yes;
    const MinkowskiVertex next = difference(farthest(of_a, -foot.sum), farthest(of_b, foot.sum));
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
  Foot foot;
  return search(corners_swept(a, motion.displacement<Dyadic>()), corners_of(b), Dyadic(a.ball_m) + Dyadic(b.ball_m),
                foot);
}

Decision polytopes_meet(const Convex& a, const Convex& b) {
  Foot foot;
  return search(corners_of(a), corners_of(b), Dyadic(a.ball_m) + Dyadic(b.ball_m), foot);
}

Decision hulls_meet(const std::vector<Point>& a, const std::vector<Point>& b, const Dyadic& radius_m) {
  Foot foot;
  return search(a, b, radius_m, foot);
}

Decision hull_meets_ball(const std::vector<Vector<Dyadic>>& points, const Dyadic& radius_m) {
  Foot foot;
  return search(points, {Point(Vec3(Vec3::Zero()))}, radius_m, foot);
}

std::optional<CommonPoint> common_point(const Convex& a, const Convex& b) {
  const std::vector<Point> of_a = corners_of(a);
  const std::vector<Point> of_b = corners_of(b);
  Foot foot;
  if (search(of_a, of_b, Dyadic(a.ball_m) + Dyadic(b.ball_m), foot) != Decision::yes) return std::nullopt;
  // The point between a's hull and b's that divides the gap in proportion to the balls; without balls, the hulls'
  // common point.
  const bool no_balls = a.ball_m == 0 && b.ball_m == 0;
  const Dyadic share_a = no_balls ? Dyadic(1.0) : Dyadic(b.ball_m);
  const Dyadic share_b = no_balls ? Dyadic() : Dyadic(a.ball_m);
  CommonPoint common{.point = Point(Vec3(Vec3::Zero())), .divisor = foot.total * (share_a + share_b)};
  for (std::size_t i = 0; i < foot.corners.size(); ++i) {
    const MinkowskiVertex& corner = foot.corners[i];
    const Dyadic& weight = foot.weights[i];
    common.point = common.point + weight * (share_a * of_a[corner.of_a] + share_b * of_b[corner.of_b]);
    common.mix_a.emplace_back(static_cast<std::uint32_t>(corner.of_a), weight);
    common.mix_b.emplace_back(static_cast<std::uint32_t>(corner.of_b), weight);
  }
  return common;
}

}  // namespace collided::engine::kernel
