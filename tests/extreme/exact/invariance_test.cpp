#include <gtest/gtest.h>

#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::invariance_test {
namespace {

using oracle::RandomShapes;

/// Every pair of kinds and every ray under a map that changes no answer.
template <class Map>
void expect_unchanged(RandomShapes& shapes, const Map& map, int count) {
  const auto compare = [&](const auto& a, const auto& b) {
    ASSERT_EQ(overlaps(map(a), map(b)).decision, overlaps(a, b).decision);
    ASSERT_EQ(overlaps(map(b), map(a)).decision, overlaps(a, b).decision);
  };
  const auto compare_ray = [&](const Ray& ray, const auto& shape) {
    RayHit before, after;
    ASSERT_EQ(cast_ray(map(ray), map(shape), after).decision, cast_ray(ray, shape, before).decision);
  };
  for (int i = 0; i < count && !testing::Test::HasFatalFailure(); ++i) {
    const Sphere s = shapes.sphere();
    const Box b = shapes.box();
    const Capsule c = shapes.capsule();
    const Triangle t = shapes.triangle();
    compare(s, shapes.sphere());
    compare(s, b);
    compare(s, c);
    compare(s, t);
    compare(b, shapes.box());
    compare(b, c);
    compare(b, t);
    compare(c, shapes.capsule());
    compare(c, t);
    compare(t, shapes.triangle());
    const Ray ray = shapes.ray(i % 2 == 0);
    compare_ray(ray, s);
    compare_ray(ray, b);
    compare_ray(ray, c);
    compare_ray(ray, t);
  }
}

// The lattice families touch in a good part of all pairs, so one wrong bit anywhere shows.
TEST(ExtremeInvariance, PowersOfTwoChangeNothing) {
  std::mt19937_64 generator = oracle::seeded(311);
  for (const oracle::Family family : {oracle::Family::lattice, oracle::Family::tenths, oracle::Family::random}) {
    RandomShapes shapes(generator, family);
    for (const int power : {-900, -300, -40, 40, 300, 900}) expect_unchanged(shapes, extreme::Scaling{power}, 8);
  }
}

TEST(ExtremeInvariance, MovingByRepresentableStepsChangesNothing) {
  std::mt19937_64 generator = oracle::seeded(312);
  RandomShapes shapes(generator, oracle::Family::lattice);
  for (const double by : {1.0, 0x1p20, 0x1p40, -0x1p49}) {
    expect_unchanged(shapes, extreme::Shift{Vec3(by, -by, 3 * by)}, 30);
  }
}

TEST(ExtremeInvariance, RenamingAndMirroringAxesChangesNothing) {
  std::mt19937_64 generator = oracle::seeded(313);
  for (const oracle::Family family : {oracle::Family::lattice, oracle::Family::tenths, oracle::Family::random}) {
    RandomShapes shapes(generator, family);
    for (const bool mirrored : {false, true}) expect_unchanged(shapes, extreme::Renaming{mirrored}, 30);
  }
}

TEST(ExtremeInvariance, RollingCornersChangesNothing) {
  std::mt19937_64 generator = oracle::seeded(314);
  RandomShapes shapes(generator, oracle::Family::tenths);
  for (int i = 0; i < 200; ++i) {
    const Triangle t = shapes.triangle();
    const Triangle rolled{t.c, t.a, t.b};
    const Ray ray = shapes.ray(true);
    RayHit hit, other;
    ASSERT_EQ(cast_ray(ray, t, hit).decision, cast_ray(ray, rolled, other).decision) << i;
    ASSERT_EQ(compare_hits(ray, t, rolled), 0) << i;
    const Sphere s = shapes.sphere();
    ASSERT_EQ(overlaps(s, t).decision, overlaps(s, rolled).decision) << i;
  }
}

}  // namespace
}  // namespace collided::engine::invariance_test
