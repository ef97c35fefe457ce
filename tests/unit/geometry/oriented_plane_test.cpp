// What double says of a side at once: never the wrong one, at any size, and the right one where there is room.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <random>

#include "server/exact_phase/arithmetic/dyadic.hpp"
#include "server/geometry/orientation.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

TEST(GeometryOrientedPlane, TheQuickSideIsTheExactOneOrNone) {
  std::mt19937_64 random = oracle::seeded(321);
  std::uniform_real_distribution<double> number(-1, 1);
  for (const int power : {-60, -30, -10, 0, 10, 30, 40, 60}) {
    const double size = std::ldexp(1.0, power);
    int near_ones = 0;
    for (int i = 0; i < 300; ++i) {
      const auto point = [&] { return Vec3(size * Vec3(number(random), number(random), number(random))); };
      const Vec3 a = point();
      const Vec3 b = point();
      const Vec3 c = point();
      const OrientedPlane plane(a, b, c);
      const Vec3 in_plane = a + number(random) * (b - a) + number(random) * (c - a);
      const int quick = plane.quick_side(in_plane);
      const int truth = *orientation(a, b, c, in_plane);
      EXPECT_TRUE(quick == 0 || quick == truth) << "2^" << power << " triangle " << i;
      near_ones += truth != 0 ? 1 : 0;
    }
    EXPECT_GT(near_ones, 100) << "the roundings put most of them beside the plane";
  }
}

TEST(GeometryOrientedPlane, TheQuickSideIsSureALittleOffThePlane) {
  for (const int power : {-60, -30, 0, 30, 60}) {
    const double size = std::ldexp(1.0, power);
    const OrientedPlane plane(Vec3::Zero(), {size, 0, 0}, {0, size, 0});
    EXPECT_EQ(plane.quick_side(size * Vec3(0.25, 0.5, 1e-12)), 1) << "2^" << power;
    EXPECT_EQ(plane.quick_side(size * Vec3(0.25, 0.5, -1e-12)), -1) << "2^" << power;
  }
}

// Whole numbers whose products need over 100 bits: the fourth corner of a parallelogram, one unit above or below it or in it.
TEST(GeometryOrientedPlane, TheSideOfAPointOneUnitOffIsThatOfItsWholeNumbers) {
  std::mt19937_64 random = oracle::seeded(322);
  std::uniform_int_distribution<std::int64_t> number(-(std::int64_t{1} << 52) / 16, (std::int64_t{1} << 52) / 16);
  int doubtful = 0;
  for (int i = 0; i < 300; ++i) {
    std::int64_t a[3], b[3], c[3];
    for (std::int64_t* point : {a, b, c}) {
      for (int axis = 0; axis < 3; ++axis) point[axis] = number(random);
    }
    const auto vector = [](const std::int64_t* p) {
      return Vec3(static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2]));
    };
    const Dyadic up = Dyadic(static_cast<double>(b[0] - a[0])) * Dyadic(static_cast<double>(c[1] - a[1])) -
                      Dyadic(static_cast<double>(b[1] - a[1])) * Dyadic(static_cast<double>(c[0] - a[0]));
    for (const int height : {-1, 0, 1}) {
      const std::int64_t d[3] = {b[0] + c[0] - a[0], b[1] + c[1] - a[1], b[2] + c[2] - a[2] + height};
      const int truth = height * up.sign();
      const OrientedPlane plane(vector(a), vector(b), vector(c));
      doubtful += plane.quick_side(vector(d)) == 0 ? 1 : 0;
      EXPECT_EQ(plane.side(vector(d)), std::optional(truth)) << i << ' ' << height;
      EXPECT_EQ(orientation(vector(a), vector(c), vector(b), vector(d)), std::optional(-truth)) << i << ' ' << height;
    }
  }
  EXPECT_GT(doubtful, 500) << "double alone must not be enough";
}

}  // namespace
}  // namespace collided::engine
