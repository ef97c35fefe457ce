#include <gtest/gtest.h>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/extreme/transformed.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::filter_boundary_test {
namespace {

/// Random rays prove nothing about a filter: these are aimed, then bisected between a hit and a miss until the two
/// directions are neighbours, and both are compared with rationals.
struct Aimed {
  Ray ray;
  Triangle triangle;
};

Aimed aimed_at_border(std::mt19937_64& generator, double spread, double distance) {
  std::uniform_real_distribution<double> any(-1, 1);
  const auto point = [&] { return Vec3(any(generator), any(generator), any(generator)); };
  Aimed aimed{{distance * point(), Vec3::UnitX()}, {point(), point(), point()}};
  aimed.triangle.c = aimed.triangle.a + spread * (aimed.triangle.c - aimed.triangle.a);
  const Vec3 middle = (aimed.triangle.a + aimed.triangle.b + aimed.triangle.c) / 3;
  const double part = any(generator) / 2 + 0.5;
  const Vec3 border = aimed.triangle.a + part * (aimed.triangle.b - aimed.triangle.a);
  Vec3 in = middle - aimed.ray.origin;
  Vec3 out = border + (border - middle) - aimed.ray.origin;
  RayHit hit;
  for (int step = 0; step < 70; ++step) {
    const Vec3 half = in + (out - in) / 2;
    aimed.ray.direction = half;
    (cast_ray(aimed.ray, aimed.triangle, hit).yes() ? in : out) = half;
  }
  return aimed;
}

TEST(ExactRayTriangle, AgreesWithRationalsAtTheFilterBoundary) {
  std::mt19937_64 generator = oracle::seeded(302);
  std::uniform_int_distribution<int> nudge(-3, 3);
  int undecided_by_filter = 0;
  for (int i = 0; i < 800; ++i) {
    Aimed aimed = aimed_at_border(generator, i % 3 == 0 ? 1e-5 : 1, i % 2 == 0 ? 1 : 1e3);
    for (double& x : aimed.ray.direction) x += nudge(generator) * 0x1p-52 * std::abs(x);
    RayHit hit;
    const ExactResult verdict = cast_ray(aimed.ray, aimed.triangle, hit);
    undecided_by_filter += verdict.level != Level::filter;
    ASSERT_EQ(verdict.yes(), oracle::first_parameter(aimed.ray, aimed.triangle).has_value()) << i;
  }
  EXPECT_GT(undecided_by_filter, 50) << "the aim was not good enough to try the filter";
}

// Cheaper than rationals, so that there can be many: corners in another order round otherwise and must agree.
TEST(ExactRayTriangle, EveryOrderOfCornersAgreesAtTheFilterBoundary) {
  std::mt19937_64 generator = oracle::seeded(304);
  std::uniform_int_distribution<int> nudge(-4, 4);
  for (int i = 0; i < 400; ++i) {
    const Aimed aimed = aimed_at_border(generator, 1, 1);
    const Triangle& t = aimed.triangle;
    const Triangle orders[] = {t, {t.b, t.c, t.a}, {t.c, t.a, t.b}, {t.b, t.a, t.c}, {t.a, t.c, t.b}, {t.c, t.b, t.a}};
    for (int near = 0; near < 100; ++near) {
      Ray ray = aimed.ray;
      for (double& x : ray.direction) x += nudge(generator) * 0x1p-53 * std::abs(x);
      RayHit hit;
      const Decision first = cast_ray(ray, t, hit).decision;
      for (const Triangle& order : orders) ASSERT_EQ(cast_ray(ray, order, hit).decision, first) << i << " " << near;
    }
  }
}

TEST(ExactRayTriangle, HardCasesKeepTheirAnswersAtEveryScale) {
  std::mt19937_64 generator = oracle::seeded(305);
  std::uniform_int_distribution<int> nudge(-4, 4);
  for (int i = 0; i < 200; ++i) {
    Aimed aimed = aimed_at_border(generator, 1, 1);
    for (double& x : aimed.ray.direction) x += nudge(generator) * 0x1p-53 * std::abs(x);
    RayHit hit;
    const Decision decision = cast_ray(aimed.ray, aimed.triangle, hit).decision;
    for (int power = -350; power <= 350; ++power) {
      const extreme::Scaling scale{power};
      ASSERT_EQ(cast_ray(scale(aimed.ray), scale(aimed.triangle), hit).decision, decision) << i << " 2^" << power;
    }
    // The direction's length means nothing. Its square may underflow while the products with it do not.
    for (int power = -900; power <= -500; power += 10) {
      const extreme::Scaling scale{200};
      Ray ray = scale(aimed.ray);
      ray.direction = extreme::Scaling{power}(aimed.ray.direction);
      ASSERT_EQ(cast_ray(ray, scale(aimed.triangle), hit).decision, decision) << i << " direction 2^" << power;
    }
  }
}

// The same at the plane: origins a few roundings before and behind the triangle.
TEST(ExactRayTriangle, AgreesWithRationalsAtThePlane) {
  std::mt19937_64 generator = oracle::seeded(303);
  std::uniform_real_distribution<double> any(-1, 1);
  std::uniform_int_distribution<int> nudge(-2, 2);
  for (int i = 0; i < 500; ++i) {
    const auto point = [&] { return Vec3(any(generator), any(generator), any(generator)); };
    const Triangle t{point(), point(), point()};
    Vec3 origin = (t.a + t.b + t.c) / 3;
    for (double& x : origin) x += nudge(generator) * 0x1p-53;
    const Ray ray{origin, point()};
    RayHit hit;
    ASSERT_EQ(cast_ray(ray, t, hit).yes(), oracle::first_parameter(ray, t).has_value()) << i;
  }
}

}  // namespace
}  // namespace collided::engine::filter_boundary_test
