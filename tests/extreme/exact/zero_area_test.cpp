// A triangle without area has no normal: libraries divide by its length, drop it, or answer anything.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::zero_area_test {
namespace {

const Triangle kSegment{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
const Triangle kPoint{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
const Triangle kFolded{{0, 0, 0}, {2, 2, 2}, {2, 2, 2}};

TEST(ExtremeZeroArea, RaysMeetTheSegmentAndThePoint) {
  RayHit hit;
  for (const Triangle& t : {kSegment, kPoint, kFolded}) {
    ASSERT_TRUE(cast_ray({{1, 1, 0}, {0, 0, 1}}, t, hit).yes());
    EXPECT_EQ(hit.distance_m, 1);
    EXPECT_TRUE(hit.normal.allFinite());
    EXPECT_TRUE(hit.weights.allFinite());
    EXPECT_NEAR(hit.weights.sum(), 1, 1e-15);
    EXPECT_FALSE(cast_ray({{1, 1.5, 0}, {0, 0, 1}}, t, hit).yes());
    EXPECT_FALSE(cast_ray({{1, extreme::up(1), 0}, {0, 0, 1}}, t, hit).yes());
  }
  ASSERT_TRUE(cast_ray({{-1, -1, -1}, {1, 1, 1}}, kSegment, hit).yes()) << "along it";
  EXPECT_NEAR(hit.distance_m, std::sqrt(3.0), 4e-16);
}

TEST(ExtremeZeroArea, BallsBoxesAndTrianglesMeetThem) {
  EXPECT_TRUE(overlaps(Sphere{{1, 1, 3}, 2}, kPoint).yes());
  EXPECT_FALSE(overlaps(Sphere{{1, 1, 3}, extreme::down(2)}, kPoint).yes());
  EXPECT_TRUE(overlaps(Sphere{{2, 2, 5}, 3}, kSegment).yes());
  EXPECT_FALSE(overlaps(Sphere{{2, 2, 5}, extreme::down(3)}, kSegment).yes());
  EXPECT_TRUE(overlaps(Box{.center = {3, 3, 3}, .half_m = {1, 1, 1}}, kSegment).yes());
  EXPECT_FALSE(overlaps(Box{.center = {3, 3, extreme::up(3)}, .half_m = {1, 1, 1}}, kSegment).yes());
  const Triangle wall{{1, -4, -4}, {1, 8, -4}, {1, 1, 9}};
  EXPECT_TRUE(overlaps(kSegment, wall).yes());
  EXPECT_TRUE(overlaps(kPoint, wall).yes());
  EXPECT_TRUE(overlaps(kPoint, kSegment).yes());
  EXPECT_FALSE(overlaps(kPoint, Triangle{{extreme::up(1), -4, -4}, {2, 8, -4}, {2, 1, 9}}).yes());
}

TEST(ExtremeZeroArea, NearestPointsAndContactsAreNumbers) {
  const Closest to_point = closest({1, 1, 4}, kPoint);
  EXPECT_EQ(to_point.distance_m, 3);
  EXPECT_EQ(to_point.normal, Vec3(0, 0, 1));
  const Closest to_segment = closest({2, 2, 5}, kSegment);
  EXPECT_LE(std::abs(to_segment.distance_m - 3), to_segment.distance_error_m);
  for (const Triangle& t : {kSegment, kPoint, kFolded}) {
    const Contact found = contact(Sphere{{1, 1, 1.5}, 1}, t);
    EXPECT_TRUE(found.normal.allFinite() && found.point.allFinite());
    EXPECT_NEAR(found.normal.norm(), 1, 1e-15);
    EXPECT_GT(found.depth_m, 0.49);
  }
  EXPECT_EQ(contact(kPoint, kPoint).depth_m, 0);
}

}  // namespace
}  // namespace collided::engine::zero_area_test
