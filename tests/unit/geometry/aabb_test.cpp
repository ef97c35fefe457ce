#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/geometry/aabb.hpp"
#include "server/geometry/stable_length.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

using oracle::Rational;

/// Every coordinate of every corner, grown by the radius, is inside; and the box is no wider than two roundings a side.
void expect_tight(const Aabb& box, const oracle::Figure& figure, double scale) {
  for (int k = 0; k < 3; ++k) {
    Rational low = figure.faces[0].origin[k];
    Rational high = low;
    for (const oracle::Face& face : figure.faces) {
      low = std::min(low, face.origin[k]);
      high = std::max(high, face.origin[k]);
    }
    low -= figure.radius;
    high += figure.radius;
    EXPECT_LE(Rational(box.low[k]), low);
    EXPECT_GE(Rational(box.high[k]), high);
    EXPECT_LE(low - Rational(box.low[k]), Rational(scale * 0x1p-49));
    EXPECT_LE(Rational(box.high[k]) - high, Rational(scale * 0x1p-49));
  }
}

TEST(GeometryAabb, ContainsTheExactShapeTightly) {
  std::mt19937_64 generator = oracle::seeded(81);
  for (const oracle::Family family : oracle::kFamilies) {
    oracle::RandomShapes shapes(generator, family);
    const double scale = family == oracle::Family::tiny ? 0x1p-556 : family == oracle::Family::far_lattice ? 4e6 : 16;
    for (int i = 0; i < 100; ++i) {
      const Sphere sphere = shapes.sphere();
      const Box box = shapes.box();
      const Capsule capsule = shapes.capsule();
      const Triangle triangle = shapes.triangle();
      expect_tight(bounds(sphere), oracle::figure(sphere), scale);
      expect_tight(bounds(box), oracle::figure(box), scale);
      expect_tight(bounds(capsule), oracle::figure(capsule), scale);
      expect_tight(bounds(triangle), oracle::figure(triangle), scale);
    }
  }
}

// No double is between a bound and the exact end of the ball, on either side of zero.
TEST(GeometryAabb, ABallsBoundsAreTheNearestDoublesOutside) {
  std::mt19937_64 generator = oracle::seeded(20261212);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const oracle::Family family : oracle::kFamilies) {
    oracle::RandomShapes shapes(generator, family);
    for (int i = 0; i < 1'000; ++i) {
      const Sphere sphere{i % 2 == 0 ? shapes.point() : Vec3(-shapes.point()), shapes.size()};
      const Aabb box = bounds(sphere);
      for (int k = 0; k < 3; ++k) {
        const Rational low = Rational(sphere.center[k]) - Rational(sphere.radius_m);
        const Rational high = Rational(sphere.center[k]) + Rational(sphere.radius_m);
        ASSERT_LE(Rational(box.low[k]), low);
        ASSERT_GT(Rational(std::nextafter(box.low[k], kInfinity)), low);
        ASSERT_GE(Rational(box.high[k]), high);
        ASSERT_LT(Rational(std::nextafter(box.high[k], -kInfinity)), high);
      }
    }
  }
}

// Exact sums are not widened: boxes that touch have bounds that touch and no more.
TEST(GeometryAabb, ExactBoundsStayExact) {
  const Aabb box = bounds(Box{{0.5, 0, 0}, Mat3::Identity(), {0.5, 1, 2}});
  EXPECT_EQ(box.low, Vec3(0, -1, -2));
  EXPECT_EQ(box.high, Vec3(1, 1, 2));
  EXPECT_EQ(bounds(Sphere{{1, 2, 3}, 0.25}).high, Vec3(1.25, 2.25, 3.25));
}

TEST(GeometryAabb, InexactBoundsGoOutward) {
  const Aabb box = bounds(Sphere{{1, 1, 1}, 1e-30});
  EXPECT_LT(box.low[0], 1);
  EXPECT_GT(box.high[0], 1);
  const double denormal = std::numeric_limits<double>::denorm_min();
  Mat3 axes = Mat3::Identity() * 0.25;
  EXPECT_GE(bounds(Box{Vec3::Zero(), axes, Vec3::Constant(denormal)}).high[0], denormal);
}

TEST(GeometryAabb, HugeCoordinatesStayContained) {
  const double huge = std::numeric_limits<double>::max();
  const Aabb box = bounds(Sphere{{huge, 0, -huge}, huge});
  EXPECT_EQ(box.high[0], std::numeric_limits<double>::infinity());
  EXPECT_EQ(box.low[0], 0);
  EXPECT_EQ(box.low[2], -std::numeric_limits<double>::infinity());
}

// Whatever its length, a normal along an axis bounds that axis on its own side, and one askew bounds nothing.
TEST(GeometryAabb, AHalfSpaceIsBoundedOnTheSideOfItsNormalAlone) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  const Vec3 point(1, 2, 3);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double length : {0.25, 0.5, 1.0, 1.5, 2.0}) {
      for (const double side : {-1.0, 1.0}) {
        const Aabb box = bounds(HalfSpace{point, side * length * Vec3::Unit(axis)});
        for (int k = 0; k < 3; ++k) {
          EXPECT_EQ(box.high[k], k == axis && side > 0 ? point[k] : kEndless) << axis << ' ' << length;
          EXPECT_EQ(box.low[k], k == axis && side < 0 ? point[k] : -kEndless) << axis << ' ' << length;
        }
      }
    }
  }
  for (const Vec3& askew : {Vec3(0.5, 1e-9, 0), Vec3(0, 0.5, 0.5), Vec3(-1e-9, 0, 1)}) {
    const Aabb box = bounds(HalfSpace{point, askew});
    EXPECT_EQ(box.low, Vec3::Constant(-kEndless));
    EXPECT_EQ(box.high, Vec3::Constant(kEndless));
  }
}

// Where squares overflow or vanish the length is what it is, and where they do not it is the plain one.
TEST(GeometryLength, LengthsFromTheLeastToTheGreatestAreRight) {
  EXPECT_EQ(stable_length({3, 4, 0}), 5);
  EXPECT_EQ(stable_length({0, 0, 0}), 0);
  for (const int power : {-1022, -600, -451, -449, 0, 449, 451, 511, 600, 1020}) {
    const double length = std::ldexp(5.0, power);
    EXPECT_NEAR(stable_length(std::ldexp(1.0, power) * Vec3(3, 0, 4)) / length, 1, 6 * 0x1p-53) << power;
  }
}

// A40: two boxes overlap where no axis parts them, touching included; an empty one overlaps nothing. On a lattice, against
// the points that both hold.
TEST(GeometryAabb, BoxesOverlapWhereTheyShareALatticePoint) {
  std::mt19937_64 random = oracle::seeded(40);
  const auto corner = [&] { return static_cast<int>(random() % 6); };
  int yes = 0, touching = 0;
  for (int i = 0; i < 100'000; ++i) {
    Aabb a, b;
    bool shared = true;
    bool touches = false;
    for (int axis = 0; axis < 3; ++axis) {
      const int a_low = corner(), a_high = corner(), b_low = corner(), b_high = corner();
      a.low[axis] = a_low, a.high[axis] = a_high, b.low[axis] = b_low, b.high[axis] = b_high;
      int common = 0;
      for (int x = 0; x < 6; ++x) common += a_low <= x && x <= a_high && b_low <= x && x <= b_high ? 1 : 0;
      shared = shared && common > 0;
      touches = touches || common == 1;
    }
    ASSERT_EQ(overlaps(a, b) && !a.empty() && !b.empty(), shared) << i;
    ASSERT_EQ(overlaps(a, b), overlaps(b, a)) << i;
    yes += shared ? 1 : 0;
    touching += shared && touches ? 1 : 0;
  }
  EXPECT_GT(yes, 1'000);
  EXPECT_GT(touching, 1'000);
  EXPECT_FALSE(overlaps(Aabb{}, Aabb{Vec3::Zero(), Vec3::Ones()}));
}

TEST(GeometryAabb, GrowingEmptyStaysEmpty) {
  EXPECT_TRUE(grown(Aabb{}, 1).empty());
  const Aabb box = grown(bounds(Triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), 0.5);
  EXPECT_EQ(box.low, Vec3(-0.5, -0.5, -0.5));
  EXPECT_EQ(box.high, Vec3(1.5, 1.5, 0.5));
}

}  // namespace
}  // namespace collided::engine
