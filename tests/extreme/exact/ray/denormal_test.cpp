#include <gtest/gtest.h>

#include <limits>

#include "server/exact_phase/ray/ray_cast.hpp"

namespace collided::engine::denormal_test {
namespace {

constexpr double kTiniest = std::numeric_limits<double>::denorm_min();

TEST(ExtremeRayDenormal, DirectionsAndOriginsAreNumbersToo) {
  const Triangle floor{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  RayHit hit;
  EXPECT_TRUE(cast_ray({{0.25, 0.25, 1}, {0, 0, -kTiniest}}, floor, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
  EXPECT_TRUE(cast_ray({{0.25, 0.25, kTiniest}, {0, 0, -kTiniest}}, floor, hit).yes());
  EXPECT_EQ(hit.distance_m, kTiniest);
  EXPECT_FALSE(cast_ray({{0.25, 0.25, -kTiniest}, {0, 0, -1}}, floor, hit).yes());
  EXPECT_TRUE(
      cast_ray({{-kTiniest, 0, 0}, {kTiniest, 0, 0}}, Box{{0.5, 0.5, 0.5}, Mat3::Identity(), {0.5, 0.5, 0.5}}, hit)
          .yes());
  EXPECT_EQ(hit.distance_m, kTiniest);
  EXPECT_TRUE(cast_ray({{-2, 0, 0}, {kTiniest, 0, 0}}, Sphere{{0, 0, 0}, 1}, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
  EXPECT_TRUE(cast_ray({{-2, 0, 0}, {kTiniest, 0, 0}}, Capsule{{0, -1, 0}, {0, 1, 0}, 1}, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
}

TEST(ExtremeRayDenormal, ZerosOfBothSignsAgree) {
  const Box box{{0.5, 0.5, 0.5}, Mat3::Identity(), {0.5, 0.5, 0.5}};
  for (const double zx : {0.0, -0.0}) {
    for (const double zy : {0.0, -0.0}) {
      RayHit hit;
      EXPECT_TRUE(cast_ray({{zx, 1, -1}, {zy, zx, 1}}, box, hit).yes()) << "along an edge";
      EXPECT_EQ(hit.distance_m, 1);
      EXPECT_TRUE(cast_ray({{zx, zy, 1}, {zy, zx, -1}}, Triangle{{zx, zy, zx}, {1, zx, zy}, {zy, 1, zx}}, hit).yes());
      EXPECT_FALSE(cast_ray({{-kTiniest, 1, -1}, {zy, zx, 1}}, box, hit).yes());
    }
  }
}

}  // namespace
}  // namespace collided::engine::denormal_test
