// U2: boxes turned by a hair: edges are parallel but for 2^-30, their cross product is rounding noise, and FCL's box test
// takes the noise for a separating axis or dies of an assertion.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::nearly_aligned_boxes_test {
namespace {

/// Axes (1, s), (-s, 1) in a plane: a turn by s to first order, and exactly this parallelepiped by declaration.
Box turned(const Vec3& center, int axis, double s) {
  Box box{.center = center, .half_m = {1, 1, 1}};
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  box.axes(v, u) = s;
  box.axes(u, v) = -s;
  return box;
}

/// The turned box's corner nearest to the other lies at place - 1 - s along u.
TEST(ExtremeNearlyAlignedBoxes, ACornerAgainstAFaceIsDecidedToTheStep) {
  const Box fixed{.center = {0, 0, 0}, .half_m = {1, 1, 1}};
  for (int axis = 0; axis < 3; ++axis) {
    for (int power = 4; power <= 50; ++power) {
      const double s = std::ldexp(1.0, -power);
      Vec3 center = Vec3::Zero();
      double& place = center[(axis + 1) % 3];
      place = 2 + s;
      EXPECT_TRUE(overlaps(fixed, turned(center, axis, s)).yes()) << "touching, 2^-" << power;
      EXPECT_TRUE(overlaps(turned(center, axis, s), fixed).yes());
      place = extreme::up(2 + s);
      EXPECT_EQ(overlaps(fixed, turned(center, axis, s)).decision, Decision::no) << "2^-" << power;
      place = 2 + s - 0x1p-51;
      const Box deeper = turned(center, axis, s);
      ASSERT_TRUE(overlaps(fixed, deeper).yes());
      const Contact found = contact(fixed, deeper);
      EXPECT_LE(std::abs(found.depth_m - 0x1p-51), found.depth_error_m + 0x1p-60);
    }
  }
}

// Far apart along an axis with every other axis overlapping: no noise may say "touching".
TEST(ExtremeNearlyAlignedBoxes, AGapIsNotTalkedAway) {
  for (int power = 8; power <= 52; ++power) {
    const double s = std::ldexp(1.0, -power);
    for (const double gap : {1e-12, 1e-6, 1.0}) {
      EXPECT_EQ(
          overlaps(Box{.center = {0, 0, 0}, .half_m = {1, 1, 1}}, turned({2 + s + gap, 0.5, -0.25}, 2, s)).decision,
          Decision::no)
          << power << " " << gap;
    }
  }
}

// A thin shelf and a tall narrow box, as in a cupboard: depth 2^-30 from above, whatever hair they are turned by.
TEST(ExtremeNearlyAlignedBoxes, ThinAndTall) {
  const Box shelf{.center = {0, 0, 0}, .half_m = {1, 0.5, 0x1p-8}};
  for (const double s : {0.0, 0x1p-50, 0x1p-40, 0x1p-30}) {
    Box jar = turned({0.25, 0.125, 0x1p-8 + 0.25 - 0x1p-30}, 2, s);
    jar.half_m = {0x1p-5, 0x1p-5, 0.25};
    ASSERT_TRUE(overlaps(shelf, jar).yes());
    const Contact found = contact(shelf, jar);
    EXPECT_LE(std::abs(found.depth_m - 0x1p-30), found.depth_error_m + 1e-24);
    EXPECT_NEAR(found.normal.z(), 1, 1e-15);
    jar.center.z() = 0x1p-8 + 0.25 + 0x1p-50;
    EXPECT_EQ(overlaps(shelf, jar).decision, Decision::no);
  }
}

}  // namespace
}  // namespace collided::engine::nearly_aligned_boxes_test
