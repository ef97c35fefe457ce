#include <gtest/gtest.h>

#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/overlap/separation_filter.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::triangle_filter_test {
namespace {

Triangle moved(const Triangle& t, const Vec3& by) { return {t.a + by, t.b + by, t.c + by}; }

/// Slides b along a line until the decision changes between neighbouring doubles, and asks rationals around there.
int try_boundary(const Triangle& a, const Triangle& b, const Vec3& along) {
  double in = 0;
  double out = 1;
  if (!overlaps(a, b).yes() || overlaps(a, moved(b, along)).yes()) return 0;
  for (int step = 0; step < 60; ++step) {
    const double half = in + (out - in) / 2;
    (overlaps(a, moved(b, half * along)).yes() ? in : out) = half;
  }
  int undecided = 0;
  for (int near = -6; near <= 6; ++near) {
    const Triangle there = moved(b, (in + near * 0x1p-54) * along);
    const Decision truth = exactly::overlaps(a, there);
    for (const Triangle& first : {a, Triangle{a.b, a.c, a.a}, Triangle{a.c, a.b, a.a}}) {
      for (const Triangle& second : {there, Triangle{there.c, there.a, there.b}, Triangle{there.b, there.a, there.c}}) {
        const Decision quick = kernel::quickly_overlaps(first, second);
        undecided += quick == Decision::undecided;
        if (quick != Decision::undecided) { EXPECT_EQ(quick, truth); }
        EXPECT_EQ(overlaps(second, first).decision, truth);
      }
    }
  }
  return undecided;
}

TEST(ExtremeTriangleFilter, AgreesWithRationalsAtTheFilterBoundary) {
  std::mt19937_64 generator = oracle::seeded(331);
  oracle::RandomShapes shapes(generator, oracle::Family::random);
  int undecided = 0;
  for (int i = 0; i < 300 && !testing::Test::HasFailure(); ++i) {
    const Triangle a = shapes.triangle();
    undecided += try_boundary(a, shapes.triangle(), 8 * shapes.point());
  }
  EXPECT_GT(undecided, 1000) << "the aim was not good enough to try the filter";
}

TEST(ExtremeTriangleFilter, FarFromOriginAndOutOfRangeItClaimsNothingWrong) {
  std::mt19937_64 generator = oracle::seeded(332);
  oracle::RandomShapes shapes(generator, oracle::Family::random);
  for (const double scale : {1e-320, 1e-200, 1e-110, 1e-100, 1e-30, 1e30, 1e100, 1e110, 1e200, 1e307}) {
    int decided = 0;
    for (int i = 0; i < 60; ++i) {
      Triangle a = shapes.triangle();
      Triangle b = shapes.triangle();
      for (Vec3* corner : {&a.a, &a.b, &a.c, &b.a, &b.b, &b.c}) *corner *= scale;
      const Decision quick = kernel::quickly_overlaps(a, b);
      if (quick == Decision::undecided) continue;
      EXPECT_EQ(quick, exactly::overlaps(a, b)) << scale;
      ++decided;
    }
    if (scale > 1e-29 && scale < 1e29) { EXPECT_GT(decided, 50); }
  }
}

}  // namespace
}  // namespace collided::engine::triangle_filter_test
