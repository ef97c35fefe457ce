// A ray in the triangle's own plane makes the determinant zero, and most ray tests answer "parallel, so no".
#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::in_plane_test {
namespace {

const Triangle kFloor{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};

void expect_hit(const Ray& ray, const Triangle& triangle, double distance_m) {
  for (const Triangle& t :
       {triangle, Triangle{triangle.b, triangle.c, triangle.a}, Triangle{triangle.c, triangle.b, triangle.a}}) {
    RayHit hit;
    ASSERT_TRUE(cast_ray(ray, t, hit).yes());
    EXPECT_LE(std::abs(hit.distance_m - distance_m), hit.distance_error_m);
    EXPECT_LE(hit.distance_error_m, 1e-15 * distance_m);
  }
}

void expect_miss(const Ray& ray, const Triangle& triangle) {
  RayHit hit;
  EXPECT_EQ(cast_ray(ray, triangle, hit).decision, Decision::no);
}

TEST(ExtremeRayInPlane, EntersThroughAnEdgeAlongAnEdgeAndAtACorner) {
  expect_hit({{-1, 0.5, 0}, {1, 0, 0}}, kFloor, 1);
  expect_hit({{-1, 0, 0}, {1, 0, 0}}, kFloor, 1);
  expect_hit({{-1, 2, 0}, {1, 0, 0}}, kFloor, 1);
  expect_hit({{3, -1, 0}, {-1, 1, 0}}, kFloor, std::sqrt(2.0));
}

TEST(ExtremeRayInPlane, AStartInsideOrOnTheBorderIsAHitAtZero) {
  expect_hit({{0.5, 0.5, 0}, {1, 1, 0}}, kFloor, 0);
  expect_hit({{1, 1, 0}, {1, 1, 0}}, kFloor, 0);
  expect_hit({{2, 0, 0}, {1, 0, 0}}, kFloor, 0);
}

TEST(ExtremeRayInPlane, OneStepBesideIsAMiss) {
  expect_miss({{-1, extreme::up(2), 0}, {1, 0, 0}}, kFloor);
  expect_miss({{-1, -0x1p-1074, 0}, {1, 0, 0}}, kFloor);
  expect_miss({{-1, 0.5, 0x1p-1074}, {1, 0, 0}}, kFloor);
  expect_miss({{-1, 0.5, 1e-300}, {1, 0, 0}}, kFloor);
  expect_miss({{1, 1 + 0x1p-52, 0}, {1, 1, 0}}, kFloor);
}

TEST(ExtremeRayInPlane, TheLengthDecidesToTheLastStep) {
  expect_hit({{-1, 0.5, 0}, {1, 0, 0}, 1}, kFloor, 1);
  expect_miss({{-1, 0.5, 0}, {1, 0, 0}, extreme::down(1)}, kFloor);
}

// The plane z = x + y: nothing is axis-aligned, so no zero helps by accident.
TEST(ExtremeRayInPlane, SlantedPlanesAtEveryScale) {
  const Triangle slanted{{0, 0, 0}, {1, 0, 1}, {0, 1, 1}};
  const Ray along{{-1, 0.25, -0.75}, {1, 0, 1}};
  const Ray above{{-1, 0.25, extreme::up(-0.75)}, {1, 0, 1}};
  for (const int power : {-500, -40, 0, 27, 500}) {
    const extreme::Scaling scale{power};
    expect_hit(scale(along), scale(slanted), scale(std::sqrt(2.0)));
    expect_miss(scale(above), scale(slanted));
  }
}

}  // namespace
}  // namespace collided::engine::in_plane_test
