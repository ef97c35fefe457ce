// A ball about the origin that is said to be in a tetrahedron is there, by rationals.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/distance/ball_inside.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::ball_inside_test {
namespace {

using kernel::DifferencePoint;
using Q = mpq_class;

struct Point {
  Q x[3];
};
Point exact(const Vec3& v) { return {{Q(v.x()), Q(v.y()), Q(v.z())}}; }
Point minus(const Point& a, const Point& b) { return {{a.x[0] - b.x[0], a.x[1] - b.x[1], a.x[2] - b.x[2]}}; }
Q dot(const Point& a, const Point& b) { return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2]; }
Point cross(const Point& a, const Point& b) {
  return {{a.x[1] * b.x[2] - a.x[2] * b.x[1], a.x[2] * b.x[0] - a.x[0] * b.x[2], a.x[0] * b.x[1] - a.x[1] * b.x[0]}};
}

bool holds_exactly(const DifferencePoint* corner, double radius_m) {
  for (int skipped = 0; skipped < 4; ++skipped) {
    const Point p = exact(corner[(skipped + 1) % 4].w);
    const Point n = cross(minus(exact(corner[(skipped + 2) % 4].w), p), minus(exact(corner[(skipped + 3) % 4].w), p));
    const Q of_face = dot(n, p);
    const Q of_corner = dot(n, exact(corner[skipped].w)) - of_face;
    const Q inward = of_corner > 0 ? Q(-of_face) : of_face;
    if (of_corner == 0 || inward < 0 || inward * inward < Q(radius_m) * Q(radius_m) * dot(n, n)) return false;
  }
  return true;
}

TEST(ExactBallInside, HoldsWhatRationalsSay) {
  std::mt19937_64 generator = oracle::seeded(4);
  std::uniform_real_distribution<double> any(-1, 1);
  int said = 0;
  int missed = 0;
  for (int i = 0; i < 20000; ++i) {
    DifferencePoint corner[4];
    for (DifferencePoint& c : corner) c.w = Vec3(any(generator), any(generator), any(generator));
    // Half of them with the origin on a face but for rounding, a radius of next to nothing.
    const bool is_hard = i % 2 == 0;
    if (is_hard) corner[3].w = -(std::abs(any(generator)) * corner[0].w + std::abs(any(generator)) * corner[1].w);
    const double radius_m = is_hard ? 0 : 0.1 * std::abs(any(generator));
    const bool holds = kernel::surely_holds_ball(corner, radius_m);
    const bool truth = holds_exactly(corner, radius_m);
    if (holds) { ASSERT_TRUE(truth) << "tetrahedron " << i; }
    said += holds ? 1 : 0;
    missed += !is_hard && truth && !holds ? 1 : 0;
  }
  EXPECT_GT(said, 300);
  EXPECT_EQ(missed, 0) << "away from the border nothing is given up";
}

}  // namespace
}  // namespace collided::engine::ball_inside_test
