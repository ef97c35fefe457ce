// A20: the implicit sphere f(p) = |p - c|^2 - r^2: whether f <= 0 is a point's overlap with the ball, and equals the sign of
// f by rationals for every point, those within an ulp of the surface and those exactly on it included.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::implicit_sphere_test {
namespace {

/// -1 inside, 0 on the surface, 1 outside.
int sign_of_implicit(const Vec3& point, const Sphere& sphere) {
  mpq_class f = -mpq_class(sphere.radius_m) * mpq_class(sphere.radius_m);
  for (int axis = 0; axis < 3; ++axis) {
    const mpq_class difference = mpq_class(point[axis]) - mpq_class(sphere.center[axis]);
    f += difference * difference;
  }
  return sgn(f);
}

bool is_in_ball(const Vec3& point, const Sphere& sphere) { return overlaps(Sphere{point, 0}, sphere).yes(); }

std::uint64_t point_count() {
  const char* asked = std::getenv("COLLIDED_IMPLICIT_POINTS");
  return asked == nullptr ? 100'000 : std::strtoull(asked, nullptr, 10);
}

/// A whole number of ulps away along one axis.
double stepped(double value, int ulps) {
  for (; ulps > 0; --ulps) value = std::nextafter(value, std::numeric_limits<double>::infinity());
  for (; ulps < 0; ++ulps) value = std::nextafter(value, -std::numeric_limits<double>::infinity());
  return value;
}

TEST(ExactImplicitSphere, TheSignOfFIsThatOfRationals) {
  std::mt19937_64 generator = oracle::seeded(20);
  std::uniform_real_distribution<double> any(-1, 1);
  std::uniform_int_distribution<int> exponent(-30, 30);
  std::uniform_int_distribution<int> ulps(-1, 1);
  std::array<std::uint64_t, 3> seen{};
  for (std::uint64_t i = 0; i < point_count(); ++i) {
    const Sphere sphere{std::ldexp(1.0, exponent(generator)) * Vec3(any(generator), any(generator), any(generator)),
                        std::ldexp(0.5 + std::abs(any(generator)), exponent(generator))};
    const Vec3 displacement = Vec3(any(generator), any(generator), any(generator)).normalized();
    // A tenth anywhere; the others rounded onto the surface, then at most an ulp beside that along each axis.
    Vec3 point = sphere.center + (i % 10 == 0 ? 2 * std::abs(any(generator)) : 1.0) * sphere.radius_m * displacement;
    if (i % 10 != 0) {
      for (double& number : point) number = stepped(number, ulps(generator));
    }
    const int sign = sign_of_implicit(point, sphere);
    ++seen[static_cast<std::size_t>(sign + 1)];
    ASSERT_EQ(is_in_ball(point, sphere), sign <= 0) << "point " << i;
  }
  EXPECT_GT(seen[0], point_count() / 10);
  EXPECT_GT(seen[2], point_count() / 10);
}

// Whole numbers with a^2 + b^2 + c^2 = d^2, far from the origin and in powers of two, so that the point is on the sphere
// and not beside it; an ulp outward is outside, an ulp inward is not.
TEST(ExactImplicitSphere, AnUlpDecidesAtPointsOnTheSurface) {
  std::uint64_t on_surface = 0;
  for (int m = -6; m <= 6; ++m) {
    for (int n = -6; n <= 6; ++n) {
      for (int p = -6; p <= 6; ++p) {
        const Vec3 leg(m * m + n * n - p * p, 2 * m * p, 2 * n * p);
        const double length = m * m + n * n + p * p;
        for (const double scale : {1.0, 0x1p-40, 0x1p60}) {
          for (const double far : {0.0, 0x1p44}) {
            const Sphere sphere{scale * Vec3(far, -far, far), scale * length};
            const Vec3 point = sphere.center + scale * leg;
            if (length == 0) continue;
            ASSERT_EQ(sign_of_implicit(point, sphere), 0);
            ++on_surface;
            EXPECT_TRUE(is_in_ball(point, sphere));
            for (int axis = 0; axis < 3; ++axis) {
              for (const int step : {-1, 1}) {
                Vec3 summand = point;
                summand[axis] = stepped(point[axis], step);
                ASSERT_EQ(is_in_ball(summand, sphere), sign_of_implicit(summand, sphere) <= 0) << summand.transpose();
              }
            }
          }
        }
      }
    }
  }
  EXPECT_EQ(on_surface, (13u * 13u * 13u - 1) * 6);
}

}  // namespace
}  // namespace collided::engine::implicit_sphere_test
