#include <gtest/gtest.h>

#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/overlap/separation_filter.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::separation_filter_test {
namespace {

Box moved(const Box& box, const Vec3& by) { return {box.center + by, box.axes, box.half_m}; }
Triangle moved(const Triangle& t, const Vec3& by) { return {t.a + by, t.b + by, t.c + by}; }

/// Slides b along a line until the decision changes between neighbouring doubles, and asks the twin there.
template <class B>
int try_boundary(std::mt19937_64& generator, const Box& a, const B& b) {
  std::uniform_real_distribution<double> any(-1, 1);
  const Vec3 along = Vec3(any(generator), any(generator), any(generator)) * 8;
  double in = 0;
  double out = 1;
  if (!overlaps(a, b).yes() || overlaps(a, moved(b, along)).yes()) return 0;
  for (int step = 0; step < 60; ++step) {
    const double half = in + (out - in) / 2;
    (overlaps(a, moved(b, half * along)).yes() ? in : out) = half;
  }
  int undecided = 0;
  for (const double at : {in, out}) {
    const B there = moved(b, at * along);
    undecided += kernel::quickly_overlaps(a, there) == Decision::undecided;
    EXPECT_EQ(overlaps(a, there).yes(), oracle::overlaps_by_clipping(a, there));
  }
  return undecided;
}

TEST(ExtremeSeparationFilter, AgreesWithRationalsAtTheFilterBoundary) {
  std::mt19937_64 generator = oracle::seeded(321);
  oracle::RandomShapes shapes(generator, oracle::Family::random);
  int undecided = 0;
  for (int i = 0; i < 80 && !testing::Test::HasFailure(); ++i) {
    undecided += try_boundary(generator, shapes.box(), shapes.box());
    undecided += try_boundary(generator, shapes.box(), shapes.triangle());
  }
  EXPECT_GT(undecided, 30) << "the aim was not good enough to try the filter";
}

Box reordered(const Box& b, int turn) {
  Box box = b;
  for (int i = 0; i < 3; ++i) {
    box.axes.col(i) = (turn & 1 << i ? -1 : 1) * b.axes.col((i + turn) % 3);
    box.half_m[i] = b.half_m[(i + turn) % 3];
  }
  return box;
}

// Axes named and directed otherwise describe the same box but round otherwise.
TEST(ExtremeSeparationFilter, EveryNamingOfTheAxesAgreesAtTheFilterBoundary) {
  std::mt19937_64 generator = oracle::seeded(323);
  oracle::RandomShapes shapes(generator, oracle::Family::random);
  for (int i = 0; i < 300; ++i) {
    const Box a = shapes.box();
    Box b = shapes.box();
    const Vec3 along = shapes.point() * 8;
    double in = 0, out = 1;
    if (!overlaps(a, b).yes() || overlaps(a, moved(b, along)).yes()) continue;
    for (int step = 0; step < 52; ++step) {
      const double half = in + (out - in) / 2;
      (overlaps(a, moved(b, half * along)).yes() ? in : out) = half;
    }
    for (int near = -3; near <= 3; ++near) {
      const Box there = moved(b, (in + near * 0x1p-53) * along);
      const Decision decision = overlaps(a, there).decision;
      for (int turn = 0; turn < 8; ++turn) {
        ASSERT_EQ(overlaps(reordered(a, turn), there).decision, decision) << i;
        ASSERT_EQ(overlaps(reordered(there, 7 - turn), a).decision, decision) << i;
      }
    }
  }
}

// Generic pairs never leave the first rung: it is what its speed is for.
TEST(ExtremeSeparationFilter, DecidesGenericPairs) {
  std::mt19937_64 generator = oracle::seeded(322);
  oracle::RandomShapes shapes(generator, oracle::Family::random);
  int undecided = 0;
  for (int i = 0; i < 2000; ++i) {
    undecided += kernel::quickly_overlaps(shapes.box(), shapes.box()) == Decision::undecided;
    undecided += kernel::quickly_overlaps(shapes.box(), shapes.triangle()) == Decision::undecided;
  }
  EXPECT_LE(undecided, 2);
}

}  // namespace
}  // namespace collided::engine::separation_filter_test
