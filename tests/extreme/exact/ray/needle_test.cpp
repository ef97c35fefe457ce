#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::needle_test {
namespace {

// One metre long, down to one denormal wide. Through its inside, its tip, and beside it.
TEST(ExtremeRayNeedle, WidthDoesNotMatter) {
  for (int power = 0; power <= 1070; power += 10) {
    const double w = std::ldexp(1.0, -power);
    const Triangle needle{{0, 0, 0}, {1, 0, 0}, {0, w, 0}};
    RayHit hit;
    EXPECT_TRUE(cast_ray({{0.25, w / 2, 1}, {0, 0, -2}}, needle, hit).yes()) << power;
    EXPECT_EQ(hit.distance_m, 1) << power;
    EXPECT_NEAR(hit.normal[2], 1, 1e-14) << power;
    EXPECT_TRUE(cast_ray({{1, 0, 1}, {0, 0, -2}}, needle, hit).yes()) << power;
    EXPECT_FALSE(cast_ray({{0.5, extreme::up(w / 2), 1}, {0, 0, -2}}, needle, hit).yes()) << power;
    EXPECT_FALSE(cast_ray({{0.5, extreme::down(0.0), 1}, {0, 0, -2}}, needle, hit).yes()) << power;
  }
}

TEST(ExtremeRayNeedle, ThinAndSlanted) {
  for (const double w : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const Triangle needle{{0, 0, 0}, {1, 1, 1}, {1, 1 + w, 1}};
    RayHit hit;
    EXPECT_TRUE(cast_ray({{0.5, 0.5, 3}, {0, 0, -1}}, needle, hit).yes()) << "its straight side, exactly";
    EXPECT_TRUE(cast_ray({{0.5, 0.5 + w / 4, 3}, {0, 0, -1}}, needle, hit).yes());
    EXPECT_NEAR(hit.distance_m, 2.5, hit.distance_error_m + 1e-15);
    EXPECT_FALSE(cast_ray({{0.5, extreme::down(0.5), 3}, {0, 0, -1}}, needle, hit).yes());
  }
}

}  // namespace
}  // namespace collided::engine::needle_test
