// A32: a ray that starts in the plane of a box's face and runs along it makes slab tests compute 0 times infinity, a NaN
// that minimum and maximum then drop.
#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::slab_test {
namespace {

Box from_to(const Vec3& low, const Vec3& high) { return {.center = (low + high) / 2, .half_m = (high - low) / 2}; }

void expect_hit(const Ray& ray, const Box& box, double distance_m) {
  RayHit hit;
  ASSERT_TRUE(cast_ray(ray, box, hit).yes());
  EXPECT_EQ(hit.distance_m, distance_m);
}

void expect_miss(const Ray& ray, const Box& box) {
  RayHit hit;
  EXPECT_EQ(cast_ray(ray, box, hit).decision, Decision::no);
}

const Box kUnit = from_to({0, 0, 0}, {1, 1, 1});

TEST(ExtremeRaySlab, AlongAFaceAndAlongAnEdge) {
  for (const double zero : {0.0, -0.0}) {
    expect_hit({{0, 0.5, -1}, {zero, 0, 1}}, kUnit, 1);
    expect_hit({{1, 1, -1}, {zero, -zero, 1}}, kUnit, 1);
    expect_hit({{zero, -zero, -1}, {zero, zero, 1}}, kUnit, 1);
    expect_hit({{-1, 0.5, 1}, {1, zero, -zero}}, kUnit, 1);
  }
}

TEST(ExtremeRaySlab, OneStepOutsideTheFaceIsAMiss) {
  for (const double zero : {0.0, -0.0}) {
    expect_miss({{-0x1p-1074, 0.5, -1}, {zero, 0, 1}}, kUnit);
    expect_miss({{extreme::up(1), 0.5, -1}, {zero, 0, 1}}, kUnit);
    expect_miss({{0.5, -0x1p-1074, -1}, {0, zero, 1}}, kUnit);
  }
}

TEST(ExtremeRaySlab, BoxesWithoutThickness) {
  expect_hit({{-1, 0.5, 0.5}, {1, 0, 0}}, from_to({0, 0, 0}, {0, 1, 1}), 1);
  expect_hit({{0, -1, 0.5}, {0, 1, 0}}, from_to({0, 0, 0}, {0, 1, 1}), 1);
  expect_hit({{-1, 0.5, 0.5}, {1, 0, 0}}, from_to({0, 0.5, 0.5}, {0, 0.5, 0.5}), 1);
  expect_miss({{-1, extreme::up(0.5), 0.5}, {1, 0, 0}}, from_to({0, 0.5, 0.5}, {0, 0.5, 0.5}));
  expect_miss({{0x1p-1074, -1, 0.5}, {0, 1, 0}}, from_to({0, 0, 0}, {0, 1, 1}));
}

TEST(ExtremeRaySlab, ADenormalDirectionIsADirection) {
  expect_hit({{-0x1p-1074, 0, 0}, {0x1p-1074, 0, 0}}, kUnit, 0x1p-1074);
  expect_hit({{-1, 0.5, 0.5}, {0x1p-1074, 0, 0}}, kUnit, 1);
  expect_hit({{0.5, 0.5, -1}, {0, 0, 0x1p1023}}, kUnit, 1);
}

}  // namespace
}  // namespace collided::engine::slab_test
