#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/ray/ray_cast.hpp"

namespace collided::engine::grazing_test {
namespace {

const Triangle kFloor{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

// From (-2, 1, h) falling h in 3: meets the floor at x = 1 exactly, however flat the flight.
TEST(ExtremeRayGrazing, TheFlattestFlightStillMeetsTheFloor) {
  for (int power = 0; power <= 1060; power += 20) {
    const double h = std::ldexp(1.0, -power);
    RayHit hit;
    EXPECT_TRUE(cast_ray({{-2, 1, h}, {3, 0, -h}}, kFloor, hit).yes()) << power;
    EXPECT_NEAR(hit.point[0], 1, 1e-9) << power;
    EXPECT_LE(std::abs(hit.distance_m - std::sqrt(9 + h * h)), hit.distance_error_m + 1e-15) << power;
    EXPECT_FALSE(cast_ray({{-2, 1, h}, {3, 0, 0}}, kFloor, hit).yes()) << power;
    EXPECT_FALSE(cast_ray({{-2, 1, h}, {3, 0, h}}, kFloor, hit).yes()) << power;
  }
}

// The double filter alone would report the distance of a hit at 1e-9 rad to seven digits.
TEST(ExtremeRayGrazing, DistanceStaysSharp) {
  for (const double h : {1e-3, 1e-6, 1e-9, 1e-12, 1e-15}) {
    RayHit hit;
    ASSERT_TRUE(cast_ray({{-1.9, 1.1, h}, {3, 0.1, -h}}, kFloor, hit).yes());
    EXPECT_LE(hit.distance_error_m, 2e-10 * hit.distance_m) << h;
    EXPECT_NEAR(hit.distance_m, std::sqrt(9.01 + h * h), 1e-9) << h;
  }
}

}  // namespace
}  // namespace collided::engine::grazing_test
