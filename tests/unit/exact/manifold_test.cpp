// Where two parts bear on each other: face 4, edge 2, corner 1.
#include <gtest/gtest.h>

#include <gmpxx.h>

#include "server/exact_phase/manifold.hpp"
#include "server/geometry/convex_hull.hpp"
#include "server/geometry/pose.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::manifold_test {
namespace {

std::vector<ManifoldPoint> manifold(const ConvexPart& a, const ConvexPart& b) {
  EXPECT_TRUE(overlaps(a, b).yes());
  const Contact found = contact(a, b);
  std::vector<ManifoldPoint> points;
  append_manifold(a, b, found, found.normal, points);
  keep_extremes(found.normal, points);
  return points;
}

Box box_at(const Vec3& center, const Vec3& half_m, const Quat& turn = Quat::Identity()) {
  return {.center = center, .axes = frame_of(Pose{Vec3::Zero(), turn}).rotation, .half_m = half_m};
}

const Primitive kFloor = box_at({0, 0, -1}, {10, 10, 1});
const Primitive kGround = HalfSpace{.point = {0, 0, 0}, .normal = {0, 0, 2}};

std::set<std::array<double, 2>> corners_of(const std::vector<ManifoldPoint>& points) {
  std::set<std::array<double, 2>> corners;
  for (const ManifoldPoint& p : points)
    corners.insert({std::round(p.point.x() * 1e6) / 1e6, std::round(p.point.y() * 1e6) / 1e6});
  return corners;
}

TEST(Manifold, ABoxOnAFloorBearsOnItsFourCorners) {
  for (const Primitive& floor : {kFloor, kGround}) {
    const Primitive box = box_at({1, 2, 0.49}, {0.5, 0.25, 0.5});
    const std::vector<ManifoldPoint> points = manifold(floor, box);
    ASSERT_EQ(points.size(), 4u);
    EXPECT_EQ(corners_of(points),
              (std::set<std::array<double, 2>>{{0.5, 1.75}, {1.5, 1.75}, {0.5, 2.25}, {1.5, 2.25}}));
    for (const ManifoldPoint& p : points) {
      EXPECT_NEAR(p.depth_m, 0.01, p.depth_error_m + 1e-15);
      EXPECT_LT(p.depth_error_m, 1e-12);
      EXPECT_NEAR(p.point.z(), -0.005, 1e-12) << "in the middle between the two surfaces";
    }
  }
}

TEST(Manifold, AnEdgeOnAFaceBearsInTwoPoints) {
  const Quat on_edge(Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitX()));
  for (const Primitive& floor : {kFloor, kGround}) {
    const Primitive box = box_at({0, 0, 0.5 * std::numbers::sqrt2 - 0.01}, {1, 0.5, 0.5}, on_edge);
    const std::vector<ManifoldPoint> points = manifold(floor, box);
    ASSERT_EQ(points.size(), 2u);
    EXPECT_EQ(corners_of(points), (std::set<std::array<double, 2>>{{-1, 0}, {1, 0}}));
    for (const ManifoldPoint& p : points) EXPECT_NEAR(p.depth_m, 0.01, p.depth_error_m + 1e-12);
  }
}

TEST(Manifold, ACornerOnAFaceBearsInOne) {
  const Quat on_corner = Quat::FromTwoVectors(Vec3(1, 1, 1), Vec3::UnitZ());
  for (const Primitive& floor : {kFloor, kGround}) {
    const Primitive box = box_at({0.3, 0.4, 0.5 * std::numbers::sqrt3 - 0.01}, {0.5, 0.5, 0.5}, on_corner);
    const std::vector<ManifoldPoint> points = manifold(floor, box);
    ASSERT_EQ(points.size(), 1u);
    EXPECT_NEAR(points[0].depth_m, 0.01, points[0].depth_error_m + 1e-12);
    EXPECT_NEAR((points[0].point - Vec3(0.3, 0.4, -0.005)).norm(), 0, 1e-9);
  }
}

TEST(Manifold, OfRoundShapes) {
  EXPECT_EQ(manifold(kFloor, Primitive(Sphere{{0, 0, 0.49}, 0.5})).size(), 1u);
  EXPECT_EQ(manifold(kFloor, Primitive(Capsule{{-1, 0, 0.49}, {1, 0, 0.49}, 0.5})).size(), 2u) << "lying";
  EXPECT_EQ(manifold(kFloor, Primitive(Capsule{{0, 0, 0.49}, {0, 0, 2}, 0.5})).size(), 1u) << "standing";
  EXPECT_EQ(manifold(kFloor, Primitive(Cylinder{{0, 0, -0.01}, {0, 0, 2}, 0.5})).size(), 4u) << "standing";
  EXPECT_EQ(manifold(kFloor, Primitive(Cylinder{{-1, 0, 0.49}, {1, 0, 0.49}, 0.5})).size(), 2u) << "lying";
  EXPECT_EQ(manifold(kFloor, Primitive(Cone{{0, 0, 2}, {0, 0, -0.01}, 0.5})).size(), 4u) << "standing";
  EXPECT_EQ(manifold(kFloor, Primitive(Cone{{0, 0, -0.01}, {0, 0, 2}, 0.5})).size(), 1u) << "on its tip";
  Ellipsoid egg{.center = {0, 0, 0.24}, .half_m = {1, 0.5, 0.25}};
  EXPECT_EQ(manifold(kFloor, Primitive(egg)).size(), 1u);
  EXPECT_EQ(manifold(Primitive(box_at({0, 0, 0}, {1, 0.1, 0.1},
                                      Quat(Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitX())))),
                     Primitive(box_at({0, 0, 0.2 * std::numbers::sqrt2 - 0.01}, {0.1, 1, 0.1},
                                      Quat(Eigen::AngleAxisd(std::numbers::pi / 4, Vec3::UnitY())))))
                .size(),
            1u)
      << "edge across edge";
}

TEST(Manifold, AHullBearsAsItsBox) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 0.5 : -0.5, i & 2 ? 0.25 : -0.25, i & 4 ? 0.5 : -0.5);
  const Hull hull{.mesh = std::make_shared<const TriangleMesh>(*convex_hull(corners)), .position = {1, 2, 0.49}};
  const std::vector<ManifoldPoint> points = manifold(kFloor, Primitive(hull));
  ASSERT_EQ(points.size(), 4u);
  EXPECT_EQ(corners_of(points), (std::set<std::array<double, 2>>{{0.5, 1.75}, {1.5, 1.75}, {0.5, 2.25}, {1.5, 2.25}}));
}

// A box that hangs over the floor's edge bears on what is over it.
TEST(Manifold, IsCutToWhatTheFacesShare) {
  const std::vector<ManifoldPoint> points = manifold(kFloor, Primitive(box_at({10, 0, 0.49}, {0.5, 0.5, 0.5})));
  ASSERT_EQ(points.size(), 4u);
  EXPECT_EQ(corners_of(points), (std::set<std::array<double, 2>>{{9.5, -0.5}, {10, -0.5}, {9.5, 0.5}, {10, 0.5}}));
}

/// How far the plane through the box's face that faces m is from the point, along n, over rationals.
mpq_class exact_height(const Box& box, int face, double side, const Vec3& point, const Vec3& n) {
  const auto q = [](double x) { return mpq_class(x); };
  mpq_class c[3];
  mpq_class m[3];
  const Vec3 u = box.axes.col((face + 1) % 3);
  const Vec3 v = box.axes.col((face + 2) % 3);
  for (int k = 0; k < 3; ++k) {
    c[k] = q(box.center[k]) + q(side) * q(box.half_m[face]) * q(box.axes(k, face)) - q(point[k]);
    m[k] = q(u[(k + 1) % 3]) * q(v[(k + 2) % 3]) - q(u[(k + 2) % 3]) * q(v[(k + 1) % 3]);
  }
  mpq_class top = 0;
  mpq_class bottom = 0;
  for (int k = 0; k < 3; ++k) {
    top += m[k] * c[k];
    bottom += m[k] * q(n[k]);
  }
  return top / bottom;
}

// The bound holds, far from the origin too, where rounding is all there is.
TEST(Manifold, TheDepthsOfTiltedBoxesAreWithinTheirBounds) {
  std::mt19937_64 generator = oracle::seeded(11);
  std::uniform_real_distribution<double> any(-1, 1);
  int seen = 0;
  double worst = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 far(i % 3 == 0 ? 1e6 : 0, 0, i % 3 == 1 ? -1e3 : 0);
    const Quat tilt = Quat(1, 0.02 * any(generator), 0.02 * any(generator), any(generator)).normalized();
    const Box floor = box_at(far + Vec3(0, 0, -1), {3, 3, 1});
    const Box box =
        box_at(far + Vec3(any(generator), any(generator), 0.45 + 0.05 * any(generator)), {0.5, 0.4, 0.5}, tilt);
    if (!overlaps(ConvexPart(Primitive(floor)), ConvexPart(Primitive(box))).yes()) continue;
    const Contact found = contact(ConvexPart(Primitive(floor)), ConvexPart(Primitive(box)));
    std::vector<ManifoldPoint> points;
    append_manifold(Primitive(floor), Primitive(box), found, found.normal, points);
    if (points.size() == 1 || std::abs(found.normal.z()) < 0.9) continue;
    for (const ManifoldPoint& p : points) {
      if (p.depth_m == 0) continue;
      const mpq_class truth =
          exact_height(floor, 2, 1, p.point, found.normal) - exact_height(box, 2, -1, p.point, found.normal);
      ASSERT_LE(std::abs(mpq_class(truth - p.depth_m).get_d()), p.depth_error_m) << "pair " << i;
      worst = std::max(worst, std::abs(mpq_class(truth - p.depth_m).get_d()) / p.depth_error_m);
      ++seen;
    }
  }
  EXPECT_GT(seen, 3000);
  EXPECT_LT(worst, 1);
  std::printf("%d points, worst error / bound %.2g\n", seen, worst);
}

// Four of many bear the load; the one that is deepest must be among them, or a solver lets it sink.
TEST(Manifold, TheDeepestOfManyPointsIsAlwaysKept) {
  std::mt19937_64 generator = oracle::seeded(12);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 200; ++i) {
    const Vec3 normal = Vec3(any(generator), any(generator), any(generator)).normalized();
    const Vec3 u = normal.unitOrthogonal();
    const Vec3 v = normal.cross(u);
    std::vector<ManifoldPoint> points;
    for (int k = 0; k < 12; ++k) {
      const double angle = 2 * std::numbers::pi * k / 12;
      points.push_back({std::cos(angle) * u + std::sin(angle) * v, 0.01 + 0.001 * any(generator), 1e-12});
    }
    const ManifoldPoint deepest{0.3 * any(generator) * u + 0.3 * any(generator) * v, 0.02, 1e-12};
    points.insert(points.begin() + i % 13, deepest);
    keep_extremes(normal, points);
    EXPECT_LE(points.size(), 4u);
    EXPECT_EQ(points.at(0).depth_m, 0.02) << i;
    EXPECT_EQ(points[0].point, deepest.point) << i;
  }
}

// Those that are kept span what all of them span: a box does not tip over on four points of one side of it.
TEST(Manifold, TheKeptPointsSpanWhatAllDid) {
  std::vector<ManifoldPoint> points;
  for (int x = 0; x <= 4; ++x) {
    for (int y = 0; y <= 2; ++y) points.push_back({Vec3(x, y, 0), x == 0 && y == 0 ? 0.02 : 0.01, 1e-12});
  }
  keep_extremes(Vec3::UnitZ(), points);
  EXPECT_EQ(corners_of(points), (std::set<std::array<double, 2>>{{0, 0}, {4, 0}, {0, 2}, {4, 2}}));
}

TEST(Manifold, PointsInALineKeepBothEnds) {
  std::vector<ManifoldPoint> points;
  for (int x = 0; x <= 6; ++x) points.push_back({Vec3(x, 0, 0), x == 2 ? 0.02 : 0.01, 1e-12});
  keep_extremes(Vec3::UnitZ(), points);
  ASSERT_EQ(points.size(), 2u) << "the deepest, and the one farthest from it";
  EXPECT_EQ(points[0].point.x(), 2);
  EXPECT_EQ(points[1].point.x(), 6);
}

}  // namespace
}  // namespace collided::engine::manifold_test
