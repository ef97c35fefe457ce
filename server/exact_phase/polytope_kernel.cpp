#include "server/exact_phase/polytope_kernel.hpp"

#include <algorithm>
#include <vector>

namespace collided::kernel {
namespace {

using Point = Vector<Dyadic>;

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

/// The corner farthest along n.
const Point& farthest(const std::vector<Point>& corners, const Point& n) {
  const Point* best = corners.data();
  Dyadic most = dot(n, *best);
  for (const Point& corner : corners) {
    Dyadic along = dot(n, corner);
    if ((along - most).sign() <= 0) continue;
    best = &corner;
    most = std::move(along);
  }
  return *best;
}

/// A nearest point to the origin as sum / total.
struct Foot {
  Point sum;
  Dyadic total;
  std::vector<Point> corners;
};

/// The origin's foot on the plane, line or point through all of them: weights that add up to a total of at least zero.
std::vector<Dyadic> weights_of(const std::vector<Point>& w) {
  if (w.size() == 1) return {Dyadic(1.0)};
  if (w.size() == 2) return {dot(w[1], w[1] - w[0]), dot(w[0], w[0] - w[1])};
  const Point n = cross(w[1] - w[0], w[2] - w[0]);
  if (w.size() == 3) return {dot(n, cross(w[1], w[2])), dot(n, cross(w[2], w[0])), dot(n, cross(w[0], w[1]))};
  const Dyadic volume = dot(n, w[3] - w[0]);
  const Dyadic turn(volume.sign() < 0 ? -1.0 : 1.0);
  // Volumes with the origin in the place of each corner.
  return {turn * dot(w[1], cross(w[2], w[3])), -turn * dot(w[0], cross(w[2], w[3])), turn * dot(w[0], cross(w[1], w[3])),
          -turn * dot(w[0], cross(w[1], w[2]))};
}

/// The simplex's nearest point to the origin lies inside exactly one of its faces that none of the other corners beats.
bool nearest_in(const std::vector<Point>& simplex, unsigned which, Foot& foot) {
  std::vector<Point> face;
  for (std::size_t i = 0; i < simplex.size(); ++i) {
    if (which >> i & 1) face.push_back(simplex[i]);
  }
  const std::vector<Dyadic> weights = weights_of(face);
  Foot found{Point(Vec3(Vec3::Zero())), Dyadic(), face};
  for (std::size_t i = 0; i < face.size(); ++i) {
    if (weights[i].sign() <= 0) return false;
    found.sum = found.sum + weights[i] * face[i];
    found.total = found.total + weights[i];
  }
  const Dyadic level = square(found.sum);
  for (const Point& corner : simplex) {
    if ((dot(found.sum, corner) * found.total - level).sign() < 0) return false;
  }
  foot = std::move(found);
  return true;
}

bool nearest_of(const std::vector<Point>& simplex, Foot& foot) {
  for (unsigned which = 1; which < 1u << simplex.size(); ++which) {
    if (nearest_in(simplex, which, foot)) return true;
  }
  return false;
}

bool is_origin(const Point& p) { return p.x.sign() == 0 && p.y.sign() == 0 && p.z.sign() == 0; }

}  // namespace

Decision polytopes_meet(const Convex& a, const Convex& b) {
  const std::vector<Point> of_a = corners_of(a);
  const std::vector<Point> of_b = corners_of(b);
  for (const std::vector<Point>* corners : {&of_a, &of_b}) {
    for (const Point& p : *corners) {
      if (!p.x.finite() || !p.y.finite() || !p.z.finite()) return Decision::undecided;
    }
  }
  const Dyadic ball = Dyadic(a.ball_m) + Dyadic(b.ball_m);
  Foot foot;
  std::vector<Point> simplex{of_a[0] - of_b[0]};
  while (nearest_of(simplex, foot)) {
    if (is_origin(foot.sum)) return Decision::yes;
    const Point next = farthest(of_a, -foot.sum) - farthest(of_b, foot.sum);
    const Dyadic level = square(foot.sum);
    const Dyadic along = dot(foot.sum, next) * foot.total;
    if (ball.sign() == 0 && along.sign() > 0) return Decision::no;
    if ((along - level).sign() >= 0) return at_most(level, ball * ball * (foot.total * foot.total));
    simplex = std::move(foot.corners);
    simplex.push_back(next);
  }
  return Decision::undecided;
}

}  // namespace collided::kernel
