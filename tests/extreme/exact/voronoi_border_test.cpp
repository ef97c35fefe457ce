// A centre on the border between a face's, an edge's and a corner's region belongs to all three; branching on a rounded
// sign jumps from one formula to another and the depth with it.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::voronoi_border_test {
namespace {

void expect_depth(const Contact& found, double depth_m) {
  EXPECT_LE(std::abs(found.depth_m - depth_m), found.depth_error_m + 1e-15);
}

TEST(ExtremeVoronoiBorder, BoxFaceEdgeAndCornerAgree) {
  const Box box{.center = {0, 0, 0}, .half_m = {1, 1, 1}};
  for (const double y : {extreme::down(1), 1.0, extreme::up(1)}) {
    for (const double z : {extreme::down(1), 1.0, extreme::up(1)}) {
      const Contact found = contact(Sphere{{2, y, z}, 1.25}, box);
      expect_depth(found, 0.25);
      EXPECT_NEAR(found.normal.x(), -1, 1e-15);
      EXPECT_NEAR(closest({2, y, z}, box).distance_m, 1, 1e-15);
    }
  }
}

TEST(ExtremeVoronoiBorder, TriangleFaceEdgeAndCornerAgree) {
  const Triangle triangle{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  for (const double y : {-0x1p-1074, -0x1p-60, 0.0, 0x1p-1074, 0x1p-60}) {
    expect_depth(contact(Sphere{{1, y, 1}, 1.5}, triangle), 0.5);
    expect_depth(contact(Sphere{{y, y, 1}, 1.5}, triangle), 0.5);
    EXPECT_NEAR(closest({y, y, -1}, triangle).distance_m, 1, 1e-15);
  }
  for (const double x : {extreme::down(1), 1.0, extreme::up(1)}) {
    EXPECT_NEAR(closest({x, 1, 1}, triangle).distance_m, 1, 1e-15) << "over the long edge";
  }
}

TEST(ExtremeVoronoiBorder, CapsuleEndAndMiddleAgree) {
  const Capsule capsule{{0, 0, 0}, {4, 0, 0}, 0.5};
  for (const double x : {-0x1p-1074, 0.0, 0x1p-60, extreme::down(4), 4.0, extreme::up(4)}) {
    expect_depth(contact(Sphere{{x, 1, 0}, 1}, capsule), 0.5);
    EXPECT_NEAR(closest({x, 0, 2}, capsule).distance_m, 1.5, 1e-15);
  }
}

// On the axis of a box's square end four faces are equally near.
TEST(ExtremeVoronoiBorder, InsideOnTheBisectorTheDepthIsOneNumber) {
  const Box box{.center = {0, 0, 0}, .half_m = {1, 1, 4}};
  for (const double x : {extreme::down(0.5), 0.5, extreme::up(0.5)}) {
    expect_depth(contact(Sphere{{x, 0.5, 0}, 0.25}, box), 0.75);
  }
}

}  // namespace
}  // namespace collided::engine::voronoi_border_test
