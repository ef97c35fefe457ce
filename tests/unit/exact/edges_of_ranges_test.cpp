// Where a range ends: the last pose of a way, the end of a movement, a root that is a line's, numbers too small for
// products; and faces that rounding has bent.
#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/distance/convex.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/manifold.hpp"
#include "server/exact_phase/motion/body_motion.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/overlap/neighbours.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/convex_hull.hpp"
#include "server/geometry/pose.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::edges_of_ranges_test {
namespace {

Hull cube(double half_m, const Vec3& position = Vec3::Zero()) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back(i & 1 ? half_m : -half_m, i & 2 ? half_m : -half_m, i & 4 ? half_m : -half_m);
  }
  return {.mesh = std::make_shared<const TriangleMesh>(*convex_hull(corners)), .position = position};
}

TEST(ExactBodyMotion, BeginsAndEndsAtItsPosesToTheBit) {
  std::mt19937_64 random = oracle::seeded(240);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto frame = [&] {
    const Quat turn(number(random), number(random), number(random), number(random));
    return frame_of({.position = Vec3(number(random), number(random), number(random)), .rotation = turn.normalized()});
  };
  for (int i = 0; i < 50; ++i) {
    const Frame from = frame();
    const Frame to = frame();
    const BodyMotion motion(from, to);
    EXPECT_TRUE(motion.at(0).position == from.position && motion.at(0).rotation == from.rotation) << i;
    EXPECT_TRUE(motion.at(1).position == to.position && motion.at(1).rotation == to.rotation) << i;
  }
}

TEST(ExactHull, ReachesAsFarWhereverItIs) {
  for (const double away_m : {0.0, 1.0, 1e3, 1e6}) {
    const kernel::Convex set(cube(0.5, Vec3(away_m, -2 * away_m, away_m)));
    EXPECT_GE(set.reach_m, std::sqrt(3.0)) << away_m;
    EXPECT_LE(set.reach_m, 1.75 + 1e-8) << away_m;
  }
}

TEST(ExactHull, ARayEntersAtTheNearestFaceAndLeavesAtTheFarthest) {
  const Hull hull = cube(0.5);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 direction = Vec3::Zero();
      direction[axis] = side;
      Vec3 summand(0.125, 0.0625, -0.25);
      summand[axis] = 0;
      RayHit hit;
      ASSERT_TRUE(cast_ray(Ray{summand - 2 * direction, direction}, hull, hit).yes()) << axis << ' ' << side;
      EXPECT_NEAR(hit.distance_m, 1.5, hit.distance_error_m) << axis << ' ' << side;
      EXPECT_NEAR(hit.exit_m, 2.5, hit.exit_error_m) << axis << ' ' << side;
      EXPECT_EQ(hit.normal, -direction);
      EXPECT_LT(hit.distance_error_m + hit.exit_error_m, 1e-12);
      ASSERT_TRUE(cast_ray(Ray{summand, direction}, hull, hit).yes()) << axis << ' ' << side;
      EXPECT_TRUE(hit.inside && hit.distance_m == 0) << axis << ' ' << side;
      EXPECT_NEAR(hit.exit_m, 0.5, hit.exit_error_m) << axis << ' ' << side;
      EXPECT_EQ(hit.normal, direction) << "of the exit";
    }
  }
}

// Parallel to a generator the ray meets the wall once, at the root of a line.
TEST(ExactCone, ARayAlongAGeneratorEndsWithItsLength) {
  const Cone cone{.apex = {0, 0, 1}, .base = {0, 0, 0}, .radius_m = 1};
  const double truth_m = 1.75 * std::numbers::sqrt2;
  RayHit hit;
  Ray ray{{-2, 0, 2.5}, {1, 0, -1}};
  ASSERT_TRUE(cast_ray(ray, cone, hit).yes());
  EXPECT_NEAR(hit.distance_m, truth_m, hit.distance_error_m + 1e-15);
  for (const double share : {0.4, 0.6, 0.8, 1 - 1e-14}) {
    ray.length_m = share * truth_m;
    EXPECT_EQ(cast_ray(ray, cone, hit).decision, Decision::no) << share;
  }
  for (const double share : {1 + 1e-14, 1.2, 2.0}) {
    ray.length_m = share * truth_m;
    EXPECT_TRUE(cast_ray(ray, cone, hit).yes()) << share;
  }
}

TEST(HalfSpace, OneWithinTheOtherIsNotApartHoweverShortTheNormals) {
  for (const double length : {0x1p-300, 0.25, 0.75, 3.0}) {
    const HalfSpace lower{{0, 0, 0}, {0, 0, length}};
    const HalfSpace upper{{5, 5, 1}, {0, 0, length / 2}};
    EXPECT_TRUE(overlaps(lower, upper).yes()) << length;
    EXPECT_TRUE(overlaps(upper, lower).yes()) << length;
  }
}

TEST(ExactFirstContact, ABallThatEndsOnASolidTouchesItAtTheVeryEnd) {
  const Cylinder cylinder{.a = {0, 0, -1}, .b = {0, 0, 1}, .radius_m = 1};
  const Cone cone{.apex = {0, 0, 1}, .base = {0, 0, -1}, .radius_m = 1};
  const auto check = [](const auto& solid) {
    TimeBracket bracket;
    ASSERT_TRUE(first_contact(MovingSphere{{0, 0, 3}, {0, 0, 1.5}, 0.5}, solid, 1e-9, bracket).yes());
    EXPECT_EQ(bracket.high, 1);
    EXPECT_GE(bracket.low, 1 - 1e-9);
    const double short_of = std::nextafter(1.5, 2.0);
    EXPECT_EQ(first_contact(MovingSphere{{0, 0, 3}, {0, 0, short_of}, 0.5}, solid, 1e-9, bracket).decision,
              Decision::no);
  };
  check(cube(1));
  check(cylinder);
  check(cone);
}

// The cross product of p and q loses a component below the least double: by what is left r and s are on one side.
TEST(ExactNeighbours, ATriangleTooSmallForProductsIsStillMet) {
  const Vec3 p = 0x1p-537 * Vec3(-1, 0, 0.45);
  const Vec3 q = 0x1p-537 * Vec3(0, -1, 0);
  const Triangle small{Vec3::Zero(), p, q};
  const Triangle large{Vec3::Zero(), {-4, 0, 1}, {4, 0, 1}};
  EXPECT_TRUE(meet_beyond_corner(small, large).yes()) << "p is in the large one";
  EXPECT_TRUE(meet_beyond_corner(large, small).yes());
}

// The hull's lower face is bent up at one corner by less than what counts as one plane: the point there says so.
TEST(Manifold, ABentFaceIsWithinTheBoundsOfItsPoints) {
  for (const double bent_m : {1e-10, 5e-10, 9e-10}) {
    std::vector<Vec3> corners;
    for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5);
    corners[3].z() += bent_m;
    const Hull hull{.mesh = std::make_shared<const TriangleMesh>(*convex_hull(corners)), .position = {0, 0, 0.49}};
    const ConvexPart floor = Primitive(Box{.center = {0, 0, -1}, .half_m = {10, 10, 1}});
    const ConvexPart part = Primitive(hull);
    const Contact found = contact(floor, part);
    std::vector<ManifoldPoint> points;
    append_manifold(floor, part, found, found.normal, points);
    ASSERT_EQ(points.size(), 4u);
    for (const ManifoldPoint& point : points) {
      const bool is_bent = point.point.x() > 0 && point.point.y() > 0;
      EXPECT_NEAR(point.depth_m, is_bent ? 0.01 - bent_m : 0.01, point.depth_error_m) << bent_m;
      EXPECT_LT(point.depth_error_m, 1e-7);
    }
  }
}

}  // namespace
}  // namespace collided::engine::edges_of_ranges_test
