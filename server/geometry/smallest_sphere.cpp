// The smallest sphere around points, up to roundings.

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "server/geometry/bounding_volumes.hpp"

namespace collided::engine {
namespace {

/// Enough for any set: the radius grows in each round, and at most about thirty rounds were ever seen.
constexpr int kMostRounds = 200;

/// How far outside, relative to the radius, a point must be for another round.
constexpr double kOutside = 1e-12;

struct Ball {
  Vec3 center = Vec3::Zero();
  double radius2 = -1;  // negative: of no points
};

/// The ball with all points on its border and its centre in their affine hull.
Ball ball_through(const std::vector<Vec3>& points) {
  const auto count = static_cast<int>(points.size()) - 1;
  Eigen::Matrix<double, 3, Eigen::Dynamic> motions(3, count);
  for (int i = 0; i < count; ++i) motions.col(i) = points[static_cast<std::size_t>(i) + 1] - points[0];
  const Eigen::MatrixXd products = motions.transpose() * motions;
  const Eigen::VectorXd shares =
      count == 0 ? Eigen::VectorXd() : Eigen::VectorXd(products.fullPivLu().solve(products.diagonal() / 2));
  const Vec3 to_center = count == 0 ? Vec3::Zero() : Vec3(motions * shares);
  return {points[0] + to_center, to_center.squaredNorm()};
}

bool holds(const Ball& ball, const Vec3& point) {
  return (point - ball.center).squaredNorm() <= ball.radius2 * (1 + kOutside);
}

/// The smallest ball around at most five points, by trying all sets of at most four; keeps those on its border.
Ball smallest_of_few(std::vector<Vec3>& points) {
  Ball best;
  std::vector<Vec3> border;
  for (unsigned set = 1; set < (1u << points.size()); ++set) {
    std::vector<Vec3> chosen;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if ((set >> i & 1) != 0) chosen.push_back(points[i]);
    }
    if (chosen.size() > 4) continue;
    const Ball ball = ball_through(chosen);
    const bool is_better = best.radius2 < 0 || ball.radius2 < best.radius2;
    if (!is_better || !ball.center.allFinite()) continue;
    if (!std::all_of(points.begin(), points.end(), [&](const Vec3& p) { return holds(ball, p); })) continue;
    best = ball;
    border = chosen;
  }
  points = border;
  return best;
}

}  // namespace

Sphere smallest_sphere(std::span<const Vec3> points) {
  const Sphere known = farthest_point_sphere(points);
  if (points.empty() || known.radius_m == 0) return known;
  // Relative to the centre and in units of the radius, so that squares stay in range.
  const auto scaled = [&](const Vec3& point) { return Vec3((point - known.center) / known.radius_m); };
  std::vector<Vec3> border{scaled(points[0])};
  Ball ball = ball_through(border);
  for (int round = 0; round < kMostRounds; ++round) {
    Vec3 farthest = border[0];
    double farthest2 = -1;
    for (const Vec3& point : points) {
      const Vec3 at = scaled(point);
      const double away2 = (at - ball.center).squaredNorm();
      if (away2 > farthest2) farthest = at, farthest2 = away2;
    }
    if (farthest2 <= ball.radius2 * (1 + kOutside)) break;
    std::vector<Vec3> few = border;
    few.push_back(farthest);
    const Ball larger = smallest_of_few(few);
    if (!(larger.radius2 > ball.radius2)) break;  // no progress except rounding
    ball = larger;
    border = few;
  }
  const Sphere sphere = sphere_about(points, known.center + known.radius_m * ball.center);
  return sphere.radius_m < known.radius_m ? sphere : known;
}

}  // namespace collided::engine
