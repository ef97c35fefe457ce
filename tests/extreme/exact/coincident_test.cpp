// A thing on top of itself has no direction from one centre to the other: 0/0 is the usual normal.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"

namespace collided::engine::coincident_test {
namespace {

void expect_depth(const Contact& found, double depth_m) {
  EXPECT_NEAR(found.depth_m, depth_m, found.depth_error_m + 1e-15 * depth_m);
  EXPECT_NEAR(found.normal.norm(), 1, 1e-15);
  EXPECT_TRUE(found.point.allFinite());
}

TEST(ExtremeCoincident, EachShapeOnItself) {
  for (const Vec3& at : {Vec3(0, 0, 0), Vec3(1e8, -1e8, 1e8), Vec3(-0.0, 1e-300, 0x1p-1074)}) {
    const Sphere sphere{at, 1};
    const Box box{.center = at, .half_m = {1, 2, 3}};
    const Capsule capsule{at, at + Vec3(0, 0, 2), 0.5};
    const Triangle triangle{at, at + Vec3(1, 0, 0), at + Vec3(0, 1, 0)};
    EXPECT_TRUE(overlaps(sphere, sphere).yes());
    EXPECT_TRUE(overlaps(box, box).yes());
    EXPECT_TRUE(overlaps(capsule, capsule).yes());
    EXPECT_TRUE(overlaps(triangle, triangle).yes());
    expect_depth(contact(sphere, sphere), 2);
    expect_depth(contact(box, box), 2);
    expect_depth(contact(capsule, capsule), 1);
    expect_depth(contact(triangle, triangle), 0);
  }
}

TEST(ExtremeCoincident, CentresOfDifferentShapes) {
  const Sphere sphere{{0, 0, 0}, 1};
  expect_depth(contact(sphere, Box{.center = {0, 0, 0}, .half_m = {1, 2, 3}}), 2);
  expect_depth(contact(sphere, Capsule{{0, 0, -1}, {0, 0, 1}, 0.5}), 1.5);
  expect_depth(contact(sphere, Triangle{{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}}), 1);
}

TEST(ExtremeCoincident, APointOnItselfTouches) {
  expect_depth(contact(Sphere{{3, 4, 5}, 0}, Sphere{{3, 4, 5}, 0}), 0);
  EXPECT_TRUE(overlaps(Box{.center = {3, 4, 5}}, Sphere{{3, 4, 5}, 0}).yes());
  EXPECT_TRUE(overlaps(Capsule{{3, 4, 5}, {3, 4, 5}, 0}, Triangle{{3, 4, 5}, {3, 4, 5}, {3, 4, 5}}).yes());
}

TEST(ExtremeCoincident, MovingOutOfItselfTouchesAtTheStart) {
  TimeBracket bracket{1, 1};
  EXPECT_TRUE(first_contact({{0, 0, 0}, {9, 0, 0}, 1}, Sphere{{0, 0, 0}, 1}, 1e-9, bracket).yes());
  EXPECT_EQ(bracket.low, 0);
  EXPECT_EQ(bracket.high, 0);
}

}  // namespace
}  // namespace collided::engine::coincident_test
