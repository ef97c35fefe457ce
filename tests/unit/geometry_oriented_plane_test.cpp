// What double says of a side at once: never the wrong one, at any size, and the right one where there is room.
#include <gtest/gtest.h>

#include <cmath>

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

}  // namespace
}  // namespace collided::engine
