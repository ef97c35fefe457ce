// The segment that two triangles share, against clipping over rationals.  // B3
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <array>
#include <optional>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/overlap/triangle_crossing.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::crossing_test {
namespace {

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
Point between(const Point& p, const Point& q, const Q& t) {
  const Point d = minus(q, p);
  return {{p.x[0] + t * d.x[0], p.x[1] + t * d.x[1], p.x[2] + t * d.x[2]}};
}

/// What of a polygon lies where n . (x - p) >= 0.
std::vector<Point> clipped(const std::vector<Point>& polygon, const Point& n, const Point& p) {
  std::vector<Point> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point& a = polygon[i];
    const Point& b = polygon[(i + 1) % polygon.size()];
    const Q at_a = dot(n, minus(a, p));
    const Q at_b = dot(n, minus(b, p));
    if (sgn(at_a) >= 0) kept.push_back(a);
    if (sgn(at_a) * sgn(at_b) < 0) kept.push_back(between(a, b, at_a / (at_a - at_b)));
  }
  return kept;
}

/// Everything of a that lies in b: cut by b's plane from both sides, then by the planes through b's edges.
std::vector<Point> shared(const Triangle& a, const Triangle& b) {
  const Point corner[3] = {exact(b.a), exact(b.b), exact(b.c)};
  const Point n = cross(minus(corner[1], corner[0]), minus(corner[2], corner[0]));
  const Point back{{-n.x[0], -n.x[1], -n.x[2]}};
  std::vector<Point> polygon{exact(a.a), exact(a.b), exact(a.c)};
  polygon = clipped(polygon, n, corner[0]);
  polygon = clipped(polygon, back, corner[0]);
  for (int i = 0; i < 3; ++i) polygon = clipped(polygon, cross(n, minus(corner[(i + 1) % 3], corner[i])), corner[i]);
  return polygon;
}

bool is_flat(const Triangle& t) {
  const Point n = cross(minus(exact(t.b), exact(t.a)), minus(exact(t.c), exact(t.a)));
  return sgn(n.x[0]) == 0 && sgn(n.x[1]) == 0 && sgn(n.x[2]) == 0;
}

/// The greatest distance between two of the points, and to the nearest of them from p.
double longest(const std::vector<Point>& points) {
  Q most = 0;
  for (const Point& p : points) {
    for (const Point& q : points) most = std::max(most, Q(dot(minus(p, q), minus(p, q))));
  }
  return std::sqrt(most.get_d());
}

class Crossings : public ::testing::TestWithParam<oracle::Family> {};

TEST_P(Crossings, AreWhatRationalsClip) {
  std::mt19937_64 generator = oracle::seeded(3);
  oracle::RandomShapes shapes(generator, GetParam());
  int met = 0;
  double worst = 0;
  for (int i = 0; i < 4000; ++i) {
    const Triangle a = shapes.triangle();
    const Triangle b = shapes.triangle();
    if (!overlaps(a, b).yes() || is_flat(a) || is_flat(b)) continue;
    ++met;
    const Crossing found = crossing(a, b);
    const Crossing turned = crossing(b, a);
    const std::vector<Point> truth = shared(a, b);
    ASSERT_FALSE(truth.empty());
    const double length = (found.to - found.from).norm();
    const double slack = 2 * found.error_m + 1e-12 * (1 + found.from.cwiseAbs().maxCoeff());
    ASSERT_NEAR(length, longest(truth), slack) << oracle::name(GetParam()) << " pair " << i;
    for (const Vec3* end : {&found.from, &found.to}) {
      for (const Triangle* t : {&a, &b}) {
        const Closest off = closest(*end, *t);
        ASSERT_LE(off.distance_m - off.distance_error_m, found.error_m) << oracle::name(GetParam()) << " pair " << i;
        worst = std::max(worst, off.distance_m);
      }
    }
    ASSERT_NEAR((turned.to - turned.from).norm(), length, slack + 2 * turned.error_m);
  }
  EXPECT_GT(met, 100);
  std::printf("%s: %d crossings, worst end %.2g m off a triangle\n", oracle::name(GetParam()), met, worst);
}

INSTANTIATE_TEST_SUITE_P(Families, Crossings, ::testing::ValuesIn(oracle::kFamiliesOfUsualSize),
                         [](const auto& family) { return std::string(oracle::name(family.param)); });

// Hand-made: through the middle, at a corner, along an edge, in one plane.
TEST(Crossing, OfKnownPairs) {
  const Triangle floor{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const Crossing through = crossing({{1, 1, -1}, {1, 1, 1}, {1, -9, 0}}, floor);
  EXPECT_EQ((through.to - through.from).norm(), 1) << "from (1, 1, 0) to the floor's edge at (1, 0, 0)";
  const Crossing corner = crossing({{1, 1, 0}, {1, 1, 1}, {2, 1, 1}}, floor);
  EXPECT_EQ(corner.from, Vec3(1, 1, 0));
  EXPECT_EQ(corner.to, Vec3(1, 1, 0));
  EXPECT_EQ(corner.error_m, 0);
  const Crossing edge = crossing({{-1, 0, 0}, {9, 0, 0}, {0, -1, 1}}, floor);
  EXPECT_NEAR((edge.to - edge.from).norm(), 4, 1e-15);
  const Crossing plane = crossing({{0, 0, 0}, {4, 4, 0}, {-4, 4, 0}}, floor);
  EXPECT_NEAR((plane.to - plane.from).norm(), 4, 1e-15) << "from (0, 0) to (0, 4), the longest in what they share";
}

}  // namespace
}  // namespace collided::engine::crossing_test
