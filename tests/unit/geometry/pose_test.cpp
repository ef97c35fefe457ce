#include <gtest/gtest.h>

#include <cmath>

#include "server/geometry/pose.hpp"

namespace collided::engine {
namespace {

TEST(GeometryPose, QuarterTurnAboutZIsExact) {
  const double half = std::sqrt(0.5);
  const Frame frame = frame_of(Pose{{10, 20, 30}, Quat(half, 0, 0, half)});
  const Vec3 placed = place(frame, Vec3(1, 0, 0));
  EXPECT_TRUE(placed.isApprox(Vec3(10, 21, 30), 1e-15));
}

// The documented order: rows times vector from the left, then the position. Another order or a fused multiply gives
// other last bits, and with them another exact input.
TEST(GeometryPose, PlacesByTheDocumentedOperations) {
  const Quat q = Quat(0.3, -0.2, 0.7, 0.1).normalized();
  const Frame frame = frame_of(Pose{{0.1, -3.7, 1e6}, q});
  const double x = q.x(), y = q.y(), z = q.z(), w = q.w();
  EXPECT_EQ(frame.rotation(0, 0), 1 - (y * (y + y) + z * (z + z)));
  EXPECT_EQ(frame.rotation(1, 0), x * (y + y) + w * (z + z));
  EXPECT_EQ(frame.rotation(1, 2), y * (z + z) - w * (x + x));
  const Vec3 p(0.3, 1.7, -2.9);
  const Mat3& r = frame.rotation;
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(place(frame, p)[k], ((r(k, 0) * p[0] + r(k, 1) * p[1]) + r(k, 2) * p[2]) + frame.position[k]);
  }
}

TEST(GeometryPose, MatrixAgreesWithTheTextbook) {
  const Quat q = Quat(0.9, -0.2, 0.35, 0.15).normalized();
  EXPECT_TRUE(frame_of(Pose{Vec3::Zero(), q}).rotation.isApprox(q.toRotationMatrix(), 1e-15));
}

TEST(GeometryPose, EveryShapeMovesWithItsPoints) {
  const Frame frame = frame_of(Pose{{1, 2, 3}, Quat(0, 0, 0, 1)});  // half a turn about z
  EXPECT_EQ(place(frame, Sphere{{1, 0, 0}, 2}).center, Vec3(0, 2, 3));
  EXPECT_EQ(place(frame, Sphere{{1, 0, 0}, 2}).radius_m, 2);
  EXPECT_EQ(place(frame, Capsule{{1, 0, 0}, {0, 1, 0}, 1}).b, Vec3(1, 1, 3));
  EXPECT_EQ(place(frame, Triangle{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}).c, Vec3(1, 2, 4));
  const Box box = place(frame, Box{{1, 0, 0}, Mat3::Identity(), {1, 2, 3}});
  EXPECT_EQ(box.center, Vec3(0, 2, 3));
  EXPECT_EQ(box.axes.col(0), Vec3(-1, 0, 0));
  EXPECT_EQ(box.half_m, Vec3(1, 2, 3));
  EXPECT_EQ(std::get<Sphere>(place(frame, Primitive(Sphere{{1, 0, 0}, 2}))).center, Vec3(0, 2, 3));
}

}  // namespace
}  // namespace collided::engine
