// A ray through a corner that many triangles share is lost between them where each one's rounding says "the other".
#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::fan_test {
namespace {

/// Six triangles around the apex, not flat: the rim goes up and down.
std::vector<Triangle> fan(const Vec3& apex) {
  const Vec3 rim[6] = {{2, 0, 1}, {1, 2, -1}, {-1, 2, 1}, {-2, 0, -1}, {-1, -2, 1}, {1, -2, -1}};
  std::vector<Triangle> all;
  for (int i = 0; i < 6; ++i) all.push_back({apex, apex + rim[i], apex + rim[(i + 1) % 6]});
  return all;
}

int hits_at(const Ray& ray, const std::vector<Triangle>& triangles, double distance_m) {
  int count = 0;
  for (const Triangle& t : triangles) {
    RayHit hit;
    if (!cast_ray(ray, t, hit).yes()) continue;
    EXPECT_LE(std::abs(hit.distance_m - distance_m), hit.distance_error_m + 4e-16 * distance_m);
    ++count;
  }
  return count;
}

TEST(ExtremeRayFan, EverySectorIsHitThroughTheApex) {
  EXPECT_EQ(hits_at({{0, 0, 1}, {0, 0, -1}}, fan(Vec3::Zero()), 1), 6);
  EXPECT_EQ(hits_at({{3, -5, 7}, {-3, 5, -7}}, fan(Vec3::Zero()), std::sqrt(83.0)), 6);
}

TEST(ExtremeRayFan, FarOutToo) {
  for (const double offset : {1e6 + 0.125, 1e8, -1e12, 1e15}) {
    const Vec3 apex(offset, -offset, offset);
    EXPECT_EQ(hits_at({apex + Vec3(3, -5, 7), {-3, 5, -7}}, fan(apex), std::sqrt(83.0)), 6) << offset;
    EXPECT_EQ(hits_at({Vec3::Zero(), apex}, fan(apex), std::sqrt(3.0) * std::abs(offset)), 6) << "from the origin";
  }
}

TEST(ExtremeRayFan, OneStepOffTheApexFewerRemainButNeverNone) {
  for (const double x : {-0x1p-1074, -0x1p-52, 0x1p-1074, 0x1p-52}) {
    const int count = hits_at({{x, 0, 1}, {0, 0, -1}}, fan(Vec3::Zero()), 1);
    EXPECT_GE(count, 1) << x;
    EXPECT_LE(count, 2) << x;
  }
}

}  // namespace
}  // namespace collided::engine::fan_test
