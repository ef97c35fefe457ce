#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::range_test {
namespace {

const Triangle kFloor{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};

void expect_same_at_every_scale(const Ray& ray, const auto& shape) {
  RayHit base;
  const Decision expected = cast_ray(ray, shape, base).decision;
  for (int power = -1000; power <= 1000; power += 50) {
    const extreme::Scaling scale{power};
    RayHit hit;
    ASSERT_EQ(cast_ray(scale(ray), scale(shape), hit).decision, expected) << "2^" << power;
    if (expected != Decision::yes) continue;
    EXPECT_LE(std::abs(hit.distance_m - scale(base.distance_m)), hit.distance_error_m + scale(base.distance_error_m))
        << "2^" << power;
    EXPECT_LE(hit.distance_error_m, scale(base.distance_m) * 1e-9) << "2^" << power;
    EXPECT_NEAR(hit.normal.dot(base.normal), 1, 1e-12) << "2^" << power;
  }
}

TEST(ExtremeRay, TinyAndHugeScenesKeepTheirAnswers) {
  expect_same_at_every_scale({{0.5, 0.75, 1}, {0.125, -0.25, -1}}, kFloor);
  expect_same_at_every_scale({{0.5, 0.75, 1}, {0.125, -0.25, -1}, 1.0}, kFloor);
  expect_same_at_every_scale({{1, 1, 1}, {0, 0, -1}, 1.0}, kFloor);
  expect_same_at_every_scale({{1, extreme::up(1.0), 1}, {0, 0, -1}, 1.0}, kFloor);
  const Vec3 across(1, 0.0625, 0.125);
  expect_same_at_every_scale({{-3, 0.25, 0.5}, across}, Sphere{{0, 0, 0}, 1});
  expect_same_at_every_scale({{-3, 0.25, 0.5}, across}, Box{{0, 0, 0}, Mat3::Identity(), {1, 1.5, 1}});
  expect_same_at_every_scale({{-3, 0.25, 0.5}, across}, Capsule{{0, 0, -1}, {0.25, 0, 1}, 0.75});
}

// Lengths 600 powers of ten apart in one question.
TEST(ExtremeRay, TinyAndHugeInOneQuestion) {
  RayHit hit;
  EXPECT_TRUE(cast_ray({{0.5, 0.5, 1e-300}, {0, 0, -1e300}}, kFloor, hit).yes());
  EXPECT_LE(std::abs(hit.distance_m - 1e-300), hit.distance_error_m + 1e-315);
  EXPECT_TRUE(cast_ray({{0.5, 0.5, 1e300}, {0, 0, -1e-300}}, kFloor, hit).yes());
  EXPECT_NEAR(hit.distance_m / 1e300, 1, 1e-12);
  const Triangle huge{{-1e300, -1e300, 0}, {1e300, -1e300, 0}, {0, 1e300, 0}};
  EXPECT_TRUE(cast_ray({{1e-300, 1e-300, 1}, {0, 0, -1}}, huge, hit).yes());
  EXPECT_EQ(hit.distance_m, 1);
  EXPECT_TRUE(cast_ray({{-1e308, 0, 0}, {1, 0, 0}}, Sphere{{1e307, 0, 0}, 1}, hit).yes());
  EXPECT_FALSE(cast_ray({{-1e308, 1 + 1e-15, 0}, {1, 0, 0}}, Sphere{{1e307, 0, 0}, 1}, hit).yes());
}

}  // namespace
}  // namespace collided::engine::range_test
