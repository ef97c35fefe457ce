// At the edge of a box one slab ends where the next begins; rounding either interval turns the touch into a miss.
#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::box_edge_test {
namespace {

const Box kUnit{.center = {0.5, 0.5, 0.5}, .half_m = {0.5, 0.5, 0.5}};

void expect_hit(const Ray& ray, double distance_m) {
  RayHit hit;
  ASSERT_TRUE(cast_ray(ray, kUnit, hit).yes());
  EXPECT_LE(std::abs(hit.distance_m - distance_m), hit.distance_error_m + 4e-16 * distance_m);
}

void expect_miss(const Ray& ray) {
  RayHit hit;
  EXPECT_EQ(cast_ray(ray, kUnit, hit).decision, Decision::no);
}

TEST(ExtremeRayBoxEdge, ThroughACornerAlongTheDiagonal) {
  expect_hit({{-1, -1, -1}, {1, 1, 1}}, std::sqrt(3.0));
  // z reaches 0 a little after x and y have.
  expect_hit({{-1, -1, -1}, {1, 1, extreme::down(1)}}, std::sqrt(3.0));
  expect_hit({{-1, 2, 0.5}, {1, -1, 0}}, std::sqrt(2.0));
}

// y = x/2 + 1 meets the edge x = 0, y = 1 and nothing else of the box.
TEST(ExtremeRayBoxEdge, TouchingAnEdgeFromOutside) {
  expect_hit({{-2, 0, 0.5}, {1, 0.5, 0}}, std::sqrt(5.0));
  expect_miss({{-2, 0, 0.5}, {1, extreme::up(0.5), 0}});
  expect_miss({{-2, 0x1p-1074, 0.5}, {1, 0.5, 0}});
  expect_hit({{-2, 0, 0.5}, {1, extreme::down(0.5), 0}}, std::sqrt(5.0));
}

TEST(ExtremeRayBoxEdge, TouchingACornerFromOutside) {
  // Through (0, 1, 1) alone: x grows, y and z too.
  expect_hit({{-2, 0, 0}, {1, 0.5, 0.5}}, std::sqrt(6.0));
  expect_miss({{-2, 0, 0}, {1, 0.5, extreme::up(0.5)}});
  expect_miss({{-2, 0, 0x1p-1074}, {1, 0.5, 0.5}});
}

TEST(ExtremeRayBoxEdge, FromTenThousandBillionKilometres) {
  for (const double far : {1e8, 1e12, 1e16}) {
    expect_hit({{far, far, far}, {-1, -1, -1}}, std::sqrt(3.0) * (far - 1));
    // One step of `far` beside: outside at the first, inside at the second.
    expect_miss({{far, far, far + 2 * (extreme::up(far) - far) + 1}, {-1, -1, 0}});
    expect_hit({{far, far, 1}, {-1, -1, 0}}, std::sqrt(2.0) * (far - 1));
    expect_miss({{far, far, extreme::up(1)}, {-1, -1, 0}});
  }
}

}  // namespace
}  // namespace collided::engine::box_edge_test
