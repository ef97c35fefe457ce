// The turn by 3-4-5, times five, keeps integers integer: (x, y, z) -> (3x - 4y, 4x + 3y, 5z). Nothing is axis-aligned any
// more, and every special case for zeros and equal coordinates must have been right.
#include <gtest/gtest.h>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::invariance_three_four_five_test {
namespace {

using oracle::RandomShapes;

struct Turn {
  Vec3 operator()(const Vec3& v) const { return {3 * v[0] - 4 * v[1], 4 * v[0] + 3 * v[1], 5 * v[2]}; }
  Sphere operator()(const Sphere& s) const { return {(*this)(s.center), 5 * s.radius_m}; }
  Capsule operator()(const Capsule& c) const { return {(*this)(c.a), (*this)(c.b), 5 * c.radius_m}; }
  Triangle operator()(const Triangle& t) const { return {(*this)(t.a), (*this)(t.b), (*this)(t.c)}; }
  Ray operator()(const Ray& r) const { return {(*this)(r.origin), (*this)(r.direction), 5 * r.length_m}; }
};

constexpr Turn kTurn;

TEST(ExtremeInvarianceThreeFourFive, DecisionsOfEveryPairStay) {
  std::mt19937_64 generator = oracle::seeded(491);
  RandomShapes shapes(generator, oracle::Family::lattice);
  int yes = 0;
  const auto compare = [&](const auto& a, const auto& b) {
    const Decision before = overlaps(a, b).decision;
    yes += before == Decision::yes ? 1 : 0;
    ASSERT_EQ(overlaps(kTurn(a), kTurn(b)).decision, before);
    ASSERT_EQ(overlaps(kTurn(kTurn(b)), kTurn(kTurn(a))).decision, before);
  };
  for (int i = 0; i < 400 && !HasFatalFailure(); ++i) {
    compare(shapes.sphere(), shapes.sphere());
    compare(shapes.sphere(), shapes.capsule());
    compare(shapes.sphere(), shapes.triangle());
    compare(shapes.capsule(), shapes.capsule());
    compare(shapes.capsule(), shapes.triangle());
    compare(shapes.triangle(), shapes.triangle());
  }
  EXPECT_GT(yes, 400) << "the scene must be worth testing";
}

TEST(ExtremeInvarianceThreeFourFive, RaysStayAndTheirDistancesAreFiveTimes) {
  std::mt19937_64 generator = oracle::seeded(492);
  RandomShapes shapes(generator, oracle::Family::lattice);
  int yes = 0;
  const auto compare = [&](const Ray& ray, const auto& shape) {
    RayHit before, after;
    const Decision decision = cast_ray(ray, shape, before).decision;
    ASSERT_EQ(cast_ray(kTurn(ray), kTurn(shape), after).decision, decision);
    if (decision != Decision::yes) return;
    ++yes;
    ASSERT_LE(std::abs(after.distance_m - 5 * before.distance_m), after.distance_error_m + 5 * before.distance_error_m);
  };
  for (int i = 0; i < 400 && !HasFatalFailure(); ++i) {
    const Ray ray = shapes.ray(i % 2 == 0);
    compare(ray, shapes.sphere());
    compare(ray, shapes.capsule());
    compare(ray, shapes.triangle());
  }
  EXPECT_GT(yes, 200) << "the scene must be worth testing";
}

TEST(ExtremeInvarianceThreeFourFive, OrderOfHitsAndNearestDistances) {
  std::mt19937_64 generator = oracle::seeded(493);
  RandomShapes shapes(generator, oracle::Family::lattice);
  for (int i = 0; i < 2'000; ++i) {
    const Ray ray = shapes.ray(false);
    const Triangle a = shapes.triangle();
    const Triangle b = shapes.triangle();
    RayHit hit;
    if (cast_ray(ray, a, hit).yes() && cast_ray(ray, b, hit).yes()) {
      ASSERT_EQ(compare_hits(kTurn(ray), kTurn(a), kTurn(b)), compare_hits(ray, a, b)) << i;
    }
    const Vec3 point = shapes.point();
    const Closest before = closest(point, a);
    const Closest after = closest(kTurn(point), kTurn(a));
    ASSERT_LE(std::abs(after.distance_m - 5 * before.distance_m), after.distance_error_m + 5 * before.distance_error_m)
        << i;
  }
}

}  // namespace
}  // namespace collided::engine::invariance_three_four_five_test
