#include <gtest/gtest.h>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/extreme/transformed.hpp"

namespace collided::engine::size_ratio_test {
namespace {

using extreme::up;

// A grain on a planet: it touches the surface or floats one step above.
TEST(ExtremeSizeRatio, AGrainOnAPlanet) {
  for (int power = 0; power <= 50; power += 5) {
    const double big = std::ldexp(1.0, power);
    const double small = 1 / big;
    const Box planet{{0, 0, -big}, Mat3::Identity(), {big, big, big}};  // its top is z = 0
    EXPECT_TRUE(overlaps(Sphere{{0.1, 0.2, small}, small}, planet).yes()) << power;
    EXPECT_FALSE(overlaps(Sphere{{0.1, 0.2, up(small)}, small}, planet).yes()) << power;
    EXPECT_TRUE(overlaps(Box{{0.1, 0.2, small}, Mat3::Identity(), Vec3::Constant(small)}, planet).yes()) << power;
    EXPECT_FALSE(overlaps(Box{{0.1, 0.2, up(small)}, Mat3::Identity(), Vec3::Constant(small)}, planet).yes()) << power;
    const Triangle plain{{-big, -big, 0}, {big, -big, 0}, {0, big, 0}};
    EXPECT_TRUE(overlaps(Sphere{{0, 0, small}, small}, plain).yes()) << power;
    EXPECT_FALSE(overlaps(Sphere{{0, 0, up(small)}, small}, plain).yes()) << power;
    EXPECT_TRUE(overlaps(Capsule{{0, 0, small}, {0, small, 2 * small}, small}, plain).yes()) << power;
    EXPECT_FALSE(overlaps(Capsule{{0, 0, up(small)}, {0, small, 2 * small}, small}, plain).yes()) << power;
  }
}

TEST(ExtremeSizeRatio, TheGrainsDepthIsTheGrainsOwn) {
  const double small = 1e-9;
  const Triangle plain{{-1e9, -1e9, 0}, {1e9, -1e9, 0}, {0, 1e9, 0}};
  const Contact c = contact(Sphere{{0, 0, small / 2}, small}, plain);
  EXPECT_LE(std::abs(c.depth_m - small / 2), c.depth_error_m + 1e-25);
  EXPECT_LE(c.depth_error_m, 1e-12 * small);
}

}  // namespace
}  // namespace collided::engine::size_ratio_test
