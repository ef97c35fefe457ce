#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/overlap/overlap.hpp"
#include "server/geometry/pose.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::touching_boxes_test {
namespace {

using extreme::down;
using extreme::up;

Box cube(const Vec3& center, const Mat3& axes = Mat3::Identity()) { return {center, axes, {1, 1, 1}}; }

TEST(ExtremeTouchingBoxes, FaceEdgeAndCorner) {
  for (const Vec3& step : {Vec3(2, 0, 0), Vec3(2, 2, 0), Vec3(2, -2, 2)}) {
    EXPECT_TRUE(overlaps(cube({0, 0, 0}), cube(step)).yes());
    for (int k = 0; k < 3; ++k) {
      Vec3 apart = step;
      if (step[k] == 0) continue;
      apart[k] = step[k] > 0 ? up(step[k]) : down(step[k]);
      EXPECT_FALSE(overlaps(cube({0, 0, 0}), cube(apart)).yes()) << step.transpose() << " axis " << k;
    }
  }
}

// Turned by the angle of 3-4-5 with axes five times too long, which stay integers: the corner of one on the face of the
// other, exactly.
TEST(ExtremeTouchingBoxes, TurnedCornerOnAFace) {
  Mat3 turned;
  turned << 3, -4, 0, 4, 3, 0, 0, 0, 5;
  const Box diamond{{0, 0, 0}, turned, {1, 1, 1}};  // reaches 7 along x and y
  EXPECT_TRUE(overlaps(diamond, cube({8, 1, 0})).yes());
  EXPECT_FALSE(overlaps(diamond, cube({up(8.0), 1, 0})).yes());
  EXPECT_TRUE(overlaps(diamond, cube({down(8.0), 1, 0})).yes());
  EXPECT_TRUE(overlaps(diamond, cube({0, 0, 6})).yes());
  EXPECT_FALSE(overlaps(diamond, cube({0, 0, up(6.0)})).yes());
}

// Edge against edge, only the cross product of two edges separates them.
TEST(ExtremeTouchingBoxes, CrossedEdges) {
  Mat3 about_x;
  about_x << 1, 0, 0, 0, 1, -1, 0, 1, 1;
  Mat3 about_y;
  about_y << 1, 0, 1, 0, 1, 0, -1, 0, 1;
  const Box low{{0, 0, 0}, about_y, {1, 1, 1}};  // its ridge is the line z = 2, x = 0
  const Box high{{0, 0, 4}, about_x, {1, 1, 1}};
  EXPECT_TRUE(overlaps(low, high).yes());
  EXPECT_FALSE(overlaps(low, Box{{0, 0, up(4.0)}, about_x, {1, 1, 1}}).yes());
  EXPECT_TRUE(overlaps(low, Box{{0, 0, down(4.0)}, about_x, {1, 1, 1}}).yes());
}

// One body on another with the same turn in double: the axes are equal, their cross products exactly zero.
TEST(ExtremeTouchingBoxes, StacksWithOneTurnAreDecidedWithoutGuessing) {
  const Frame frame = frame_of({{0.1, 0.2, 0.3}, Quat(0.9, 0.1, -0.3, 0.2).normalized()});
  for (int i = 1; i < 50; ++i) {
    const Vec3 half = Vec3::Constant(0.1 * i);
    const Box low = place(frame, Box{{0, 0, 0}, Mat3::Identity(), half});
    const Box in = place(frame, Box{{0, 0, 1.999 * half[2]}, Mat3::Identity(), half});
    const Box out = place(frame, Box{{0, 0, 2.001 * half[2]}, Mat3::Identity(), half});
    EXPECT_TRUE(overlaps(low, in).yes());
    EXPECT_FALSE(overlaps(low, out).yes());
    EXPECT_EQ(overlaps(low, in).level, Level::filter);
    EXPECT_EQ(overlaps(low, out).level, Level::filter);
  }
}

// Axes that do not span space describe no box: no answer rather than a wrong one.
TEST(ExtremeTouchingBoxes, SingularAxesAreUndecided) {
  Mat3 flat = Mat3::Identity();
  flat.col(2) = flat.col(0);
  EXPECT_EQ(overlaps(cube({0, 0, 0}), cube({0, 0, 0}, flat)).decision, Decision::undecided);
  EXPECT_EQ(overlaps(Sphere{{0, 0, 0}, 1}, cube({0, 0, 0}, flat)).decision, Decision::undecided);
}

}  // namespace
}  // namespace collided::engine::touching_boxes_test
