#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/nearest_filter.hpp"
#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::nearest_filter_test {
namespace {

/// Points at every scale of distance from a triangle of about unit size: above its inside, its edges, its corners.
Vec3 place_near(const Triangle& t, std::mt19937_64& random) {
  std::uniform_real_distribution<double> part(-0.5, 1.5);
  std::uniform_int_distribution<int> decade(-9, 2);
  std::normal_distribution<double> normal;
  const double v = part(random);
  const double w = part(random);
  Vec3 off;
  for (double& x : off) x = normal(random);
  return t.a + v * (t.b - t.a) + w * (t.c - t.a) + std::pow(10.0, decade(random)) * off;
}

TEST(ExtremeNearestFilter, TheBracketHoldsTheTruth) {
  std::mt19937_64 random = oracle::seeded(977);
  oracle::RandomShapes shapes(random, oracle::Family::random);
  int narrow = 0;
  constexpr int kTries = 20'000;
  for (int i = 0; i < kTries && !testing::Test::HasFailure(); ++i) {
    const Triangle t = shapes.triangle();
    const Vec3 p = place_near(t, random);
    const kernel::SquareBracket distance = kernel::quick_square_distance(p, t);
    // Two roundings between a square and a radius whose exact square is on the safe side.
    const double below = std::sqrt(distance.low2_m2) * (1 - 0x1p-51);
    const double above = std::sqrt(distance.high2_m2) * (1 + 0x1p-51);
    if (below > 0) { EXPECT_EQ(exactly::overlaps(Sphere{p, below}, t), Decision::no) << i; }
    if (std::isfinite(above)) { EXPECT_EQ(exactly::overlaps(Sphere{p, above}, t), Decision::yes) << i; }
    narrow += above - below <= 1e-9 * above ? 1 : 0;
  }
  EXPECT_GT(narrow, kTries / 2) << "a bracket that says nothing is no filter";
}

TEST(ExtremeNearestFilter, SpheresAgreeWithRationalsAtTheBoundary) {
  std::mt19937_64 random = oracle::seeded(978);
  oracle::RandomShapes shapes(random, oracle::Family::random);
  for (int i = 0; i < 4'000 && !testing::Test::HasFailure(); ++i) {
    const Triangle t = shapes.triangle();
    const Vec3 p = place_near(t, random);
    const double truth_m = exactly::closest(p, t).distance_m;
    for (int ulps = -3; ulps <= 3; ++ulps) {
      const Sphere sphere{p, truth_m * (1 + ulps * 0x1p-52)};
      EXPECT_EQ(overlaps(sphere, t).decision, exactly::overlaps(sphere, t)) << i;
    }
  }
}

// What the search for the deepest contact leaves out must not be deeper.
TEST(ExtremeNearestFilter, NoContactIsDeeperThanItsBound) {
  std::mt19937_64 random = oracle::seeded(979);
  oracle::RandomShapes shapes(random, oracle::Family::random);
  int near = 0;
  int met = 0;
  for (int i = 0; i < 4'000; ++i) {
    const Triangle t = shapes.triangle();
    const Sphere sphere = shapes.sphere();
    const Box box = shapes.box();
    double of_sphere_m = std::numeric_limits<double>::infinity();
    double of_box_m = of_sphere_m;
    if (overlaps(sphere, t, of_sphere_m).yes()) {
      const double depth_m = contact(sphere, t).depth_m;
      EXPECT_LE(depth_m, of_sphere_m) << i;
      near += of_sphere_m - depth_m <= 1e-6 * sphere.radius_m ? 1 : 0;
      ++met;
    }
    if (overlaps(box, t, of_box_m).yes()) { EXPECT_LE(contact(box, t).depth_m, of_box_m) << i; }
  }
  EXPECT_GT(near, met / 2);
}

}  // namespace
}  // namespace collided::engine::nearest_filter_test
