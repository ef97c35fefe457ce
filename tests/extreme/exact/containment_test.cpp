// One shape deep inside another touches no surface: boundary tests say "separate", and the way out has several ties.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"

namespace collided::engine::containment_test {
namespace {

const Box kRoom{.center = {0, 0, 0}, .half_m = {5, 5, 5}};
const Sphere kPlanet{{0, 0, 0}, 5};

/// Along one axis, to the rounding of a unit vector.
void expect_axis(const Vec3& normal) { EXPECT_NEAR(normal.cwiseAbs().maxCoeff(), 1, 1e-15); }

TEST(ExtremeContainment, EverythingInsideOverlaps) {
  const Sphere ball{{1, 1, 1}, 1};
  const Box box{.center = {1, 1, 1}, .half_m = {1, 1, 1}};
  const Capsule capsule{{1, 1, 1}, {2, 1, 1}, 0.5};
  const Triangle triangle{{1, 1, 1}, {2, 1, 1}, {1, 2, 1}};
  EXPECT_TRUE(overlaps(ball, kRoom).yes());
  EXPECT_TRUE(overlaps(box, kRoom).yes());
  EXPECT_TRUE(overlaps(kRoom, capsule).yes());
  EXPECT_TRUE(overlaps(kRoom, triangle).yes());
  EXPECT_TRUE(overlaps(ball, kPlanet).yes());
  EXPECT_TRUE(overlaps(kPlanet, box).yes());
  EXPECT_TRUE(overlaps(kPlanet, capsule).yes());
  EXPECT_TRUE(overlaps(kPlanet, triangle).yes());
  EXPECT_TRUE(overlaps(Capsule{{-9, 0, 0}, {9, 0, 0}, 4}, triangle).yes());
}

TEST(ExtremeContainment, TheDepthIsTheShortestWayOut) {
  const Contact centered = contact(Sphere{{0, 0, 0}, 1}, kRoom);
  EXPECT_NEAR(centered.depth_m, 6, centered.depth_error_m + 1e-15);
  expect_axis(centered.normal);
  const Contact boxes = contact(kRoom, Box{.center = {0, 0, 0}, .half_m = {1, 1, 1}});
  EXPECT_NEAR(boxes.depth_m, 6, boxes.depth_error_m + 1e-15);
  expect_axis(boxes.normal);
  const Contact spheres = contact(kPlanet, Sphere{{1, 0, 0}, 1});
  EXPECT_NEAR(spheres.depth_m, 5, spheres.depth_error_m + 1e-15);
  EXPECT_NEAR(spheres.normal.x(), 1, 1e-15);
  const Contact sheet = contact(kRoom, Triangle{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
  EXPECT_NEAR(sheet.depth_m, 5, sheet.depth_error_m + 1e-15);
  EXPECT_NEAR(std::abs(sheet.normal.z()), 1, 1e-15);
}

TEST(ExtremeContainment, OffCentreTheTieIsGone) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-1.0, 1.0}) {
      Vec3 center = Vec3::Zero();
      center[axis] = side * 0x1p-40;
      const Contact found = contact(Sphere{center, 1}, kRoom);
      EXPECT_NEAR(found.depth_m, 6, 1e-11);
      EXPECT_NEAR(found.normal[axis], -side, 1e-15) << "the room is pushed the other way";
    }
  }
}

TEST(ExtremeContainment, InsideASolidTheDistanceIsZero) {
  EXPECT_EQ(closest({1, 2, 3}, kRoom).distance_m, 0);
  EXPECT_EQ(closest({1, 2, 3}, kPlanet).distance_m, 0);
  EXPECT_EQ(closest({0, 0, 0}, kPlanet).distance_m, 0);
  EXPECT_EQ(closest({5, 5, 5}, kRoom).distance_m, 0);
}

}  // namespace
}  // namespace collided::engine::containment_test
