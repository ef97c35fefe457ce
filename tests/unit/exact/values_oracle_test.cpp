#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::values_oracle_test {
namespace {

using oracle::exact;
using oracle::Family;
using oracle::Figure;
using oracle::figure;
using oracle::Point;
using oracle::RandomShapes;
using oracle::Rational;
using oracle::Wide;

const auto kSphere = [](RandomShapes& s) { return s.sphere(); };
const auto kBox = [](RandomShapes& s) { return s.box(); };
const auto kCapsule = [](RandomShapes& s) { return s.capsule(); };
const auto kTriangle = [](RandomShapes& s) { return s.triangle(); };

double scale_of(Family family) { return family == Family::tiny ? 0x1p-560 : family == Family::far_lattice ? 1e6 : 1.0; }

template <class MakeShape>
void compare_closest(int count, std::uint64_t seed, MakeShape make) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const Family family : oracle::kFamilies) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < count; ++i) {
      const Vec3 point = shapes.point();
      const auto shape = make(shapes);
      const Closest found = closest(point, shape);
      const Wide truth = oracle::distance(figure(Sphere{point, 0}), figure(shape));
      const auto where = [&] { return testing::Message() << name(family) << " " << i << " truth " << truth; };
      ASSERT_LE(abs(Wide(found.distance_m) - truth), Wide(found.distance_error_m) + truth * Wide(1e-90)) << where();
      ASSERT_LE(found.distance_error_m, 1e-12 * found.distance_m) << where();
      ASSERT_NEAR(found.normal.norm(), 1, 1e-14) << where();
      const double scale = scale_of(family);
      const Wide off = oracle::distance(figure(Sphere{found.point, 0}), figure(shape));
      ASSERT_LE(off, Wide(1e-14 * scale)) << where();
      if (found.distance_m > 0) {
        const Vec3 back = (point - found.point) - found.distance_m * found.normal;
        ASSERT_LE(back.cwiseAbs().maxCoeff(), 1e-14 * scale) << where();
      }
    }
  }
}

TEST(ExactClosestOracle, Sphere) { compare_closest(200, 31, kSphere); }
TEST(ExactClosestOracle, Box) { compare_closest(25, 32, kBox); }
TEST(ExactClosestOracle, Capsule) { compare_closest(200, 33, kCapsule); }
TEST(ExactClosestOracle, Triangle) { compare_closest(200, 34, kTriangle); }

Point times(const Rational& s, const Vec3& v) { return {s * Rational(v[0]), s * Rational(v[1]), s * Rational(v[2])}; }

/// Moved by the depth and its bound (and 1e-13 of the size, because the normal is rounded) the two are apart.
void expect_parted(const Contact& c, const Figure& a, const Figure& b, double scale) {
  const Rational push = Rational(c.depth_m) + Rational(c.depth_error_m) + Rational(1e-12 * scale);
  EXPECT_FALSE(oracle::overlaps(a, oracle::shifted(b, times(push, c.normal))));
}

void expect_least(const Contact& c, const Figure& a, const Figure& b, double scale) {
  const Rational squared = oracle::squared_distance(a, b);
  const Wide radii(a.radius + b.radius);
  if (squared > 0) {
    const Wide truth = radii - sqrt(Wide(squared));
    EXPECT_LE(abs(Wide(c.depth_m) - truth), Wide(c.depth_error_m) + radii * Wide(1e-90)) << truth;
  } else {
    const double truth = static_cast<double>(radii) + oracle::part_length(a, b);
    EXPECT_NEAR(c.depth_m, truth, c.depth_error_m + 1e-9 * scale);
  }
}

template <class MakeA, class MakeB>
void compare_contact(int count, std::uint64_t seed, MakeA make_a, MakeB make_b) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const Family family : oracle::kFamilies) {
    RandomShapes shapes(generator, family);
    const double scale = family == Family::tiny ? 0x1p-560 : 4.0;
    for (int i = 0, tries = 0; i < count && tries < 50 * count; ++tries) {
      const auto a = make_a(shapes);
      const auto b = make_b(shapes);
      if (!overlaps(a, b).yes()) continue;
      ++i;
      const Contact c = contact(a, b);
      EXPECT_NEAR(c.normal.norm(), 1, 1e-14);
      EXPECT_LE(c.depth_error_m, 1e-8 * scale);
      EXPECT_TRUE(c.point.allFinite());
      expect_least(c, figure(a), figure(b), scale);
      if (family != Family::tiny) expect_parted(c, figure(a), figure(b), family == Family::far_lattice ? 1e6 : 4.0);
      ASSERT_FALSE(testing::Test::HasFailure()) << name(family) << " " << tries << " depth " << c.depth_m << " +- "
                                                << c.depth_error_m << " normal " << c.normal.transpose();
    }
  }
}

TEST(ExactContactOracle, SphereSphere) { compare_contact(100, 41, kSphere, kSphere); }
TEST(ExactContactOracle, SphereBox) { compare_contact(20, 42, kSphere, kBox); }
TEST(ExactContactOracle, SphereCapsule) { compare_contact(100, 43, kSphere, kCapsule); }
TEST(ExactContactOracle, SphereTriangle) { compare_contact(60, 44, kSphere, kTriangle); }
TEST(ExactContactOracle, BoxCapsule) { compare_contact(10, 45, kBox, kCapsule); }
TEST(ExactContactOracle, BoxTriangle) { compare_contact(3, 46, kBox, kTriangle); }
TEST(ExactContactOracle, CapsuleCapsule) { compare_contact(60, 47, kCapsule, kCapsule); }
TEST(ExactContactOracle, CapsuleTriangle) { compare_contact(20, 48, kCapsule, kTriangle); }
TEST(ExactContactOracle, TriangleTriangle) { compare_contact(15, 49, kTriangle, kTriangle); }

// 64 points of the Minkowski difference, but exact distances of two boxes are slow: only the least push is compared.
TEST(ExactContactOracle, BoxBox) {
  std::mt19937_64 generator = oracle::seeded(50);
  for (const Family family : {Family::random, Family::lattice, Family::tenths}) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 12;) {
      const Box a = shapes.box();
      const Box b = shapes.box();
      if (!overlaps(a, b).yes()) continue;
      ++i;
      const Contact c = contact(a, b);
      EXPECT_NEAR(c.depth_m, oracle::part_length(figure(a), figure(b)), c.depth_error_m + 1e-8) << name(family) << i;
      const Rational push = Rational(c.depth_m) + Rational(c.depth_error_m) + Rational(1e-12);
      EXPECT_FALSE(oracle::overlaps_by_clipping(a, b, times(push, c.normal))) << name(family) << i;
    }
  }
}

Figure path(const MovingSphere& mover, double t) {
  const Point start = exact(mover.start);
  const Point end = exact(mover.end);
  Point at;
  for (int k = 0; k < 3; ++k) at[k] = start[k] + Rational(t) * (end[k] - start[k]);
  Figure result = oracle::segment_figure(start, at);
  result.radius = Rational(mover.radius_m);
  return result;
}

template <class MakeShape>
void compare_first_contact(int count, std::uint64_t seed, MakeShape make) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const Family family : oracle::kFamilies) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < count; ++i) {
      const MovingSphere mover{shapes.point(), shapes.point(), shapes.size()};
      const auto other = make(shapes);
      const double width = i % 3 == 0 ? 0 : i % 3 == 1 ? 1e-9 : 1e-3;
      TimeBracket bracket{-1, -1};
      const bool truth = oracle::overlaps(path(mover, 1), figure(other));
      ASSERT_EQ(first_contact(mover, other, width, bracket).decision, truth ? Decision::yes : Decision::no);
      if (!truth) continue;
      ASSERT_TRUE(oracle::overlaps(path(mover, bracket.high), figure(other))) << name(family) << " " << i;
      if (bracket.high == 0) {
        ASSERT_EQ(bracket.low, 0);
        continue;
      }
      ASSERT_FALSE(oracle::overlaps(path(mover, bracket.low), figure(other))) << name(family) << " " << i;
      ASSERT_TRUE(bracket.high - bracket.low <= width || std::nextafter(bracket.low, 1.0) == bracket.high);
    }
  }
}

TEST(ExactFirstContactOracle, Sphere) { compare_first_contact(60, 61, kSphere); }
TEST(ExactFirstContactOracle, Box) { compare_first_contact(8, 62, kBox); }
TEST(ExactFirstContactOracle, Capsule) { compare_first_contact(40, 63, kCapsule); }
TEST(ExactFirstContactOracle, Triangle) { compare_first_contact(30, 64, kTriangle); }

}  // namespace
}  // namespace collided::engine::values_oracle_test
