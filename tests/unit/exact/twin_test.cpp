#include <gtest/gtest.h>

#include <cmath>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::twin_test {
namespace {

using oracle::RandomShapes;

const auto kSphere = [](RandomShapes& s) { return s.sphere(); };
const auto kBox = [](RandomShapes& s) { return s.box(); };
const auto kCapsule = [](RandomShapes& s) { return s.capsule(); };
const auto kTriangle = [](RandomShapes& s) { return s.triangle(); };

/// Two values within the sum of their bounds.
void expect_same(double a, double a_error, double b, double b_error) {
  EXPECT_LE(std::abs(a - b), (a_error + b_error) * (1 + 1e-15))
      << a << " +- " << a_error << ", " << b << " +- " << b_error;
}

/// The point, each coordinate some units in the last place of `scale` off.
Vec3 near_to(const Vec3& point, double scale, std::mt19937_64& generator) {
  std::uniform_int_distribution<int> units(-3, 3);
  return point + scale * 0x1p-53 * Vec3(units(generator), units(generator), 0);
}

// Two needles side by side in a plane, that cross or do not by a rounding of their lengths, as thin as lines or nearly.
TEST(ExactTwin, NeedlesThatLieAlongEachOtherMeetAsRationalsSay) {
  std::mt19937_64 generator = oracle::seeded(309);
  std::uniform_real_distribution<double> part(-1, 1);
  int met = 0;
  constexpr int kPairs = 4'000;
  for (int i = 0; i < kPairs; ++i) {
    const Vec3 along(3 * part(generator), part(generator), i % 3 == 0 ? part(generator) : 0);
    const double size = along.cwiseAbs().maxCoeff();
    const Vec3 start = i % 2 == 0 ? Vec3(Vec3::Zero()) : Vec3(part(generator), part(generator), 0);
    const Vec3 a = start, b = start + along;
    const double fine = i % 5 == 0 ? 0x1p-20 : 1;
    const Vec3 c = near_to(a, size * fine, generator), d = near_to(b, size, generator);
    const Triangle one{a, b, i % 7 == 0 ? Vec3(a + along / 2) : b};
    const Triangle other{c, d, i % 11 == 0 ? c : d};
    const Decision expected = exactly::overlaps(one, other);
    ASSERT_EQ(overlaps(one, other).decision, expected) << i;
    met += expected == Decision::yes ? 1 : 0;
  }
  EXPECT_GT(met, kPairs / 10);
  EXPECT_LT(met, kPairs - kPairs / 10);
}

template <class Make>
void compare_rays(Make make, std::uint64_t seed) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const oracle::Family family : oracle::kFamilies) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 300; ++i) {
      const auto shape = make(shapes);
      const Ray ray = shapes.ray(i % 2 == 0);
      RayHit fast, slow;
      const Decision decision = cast_ray(ray, shape, fast).decision;
      ASSERT_EQ(exactly::cast_ray(ray, shape, slow), decision) << name(family) << " " << i;
      if (decision != Decision::yes) continue;
      expect_same(fast.distance_m, fast.distance_error_m, slow.distance_m, slow.distance_error_m);
      EXPECT_LE(slow.distance_error_m, 1e-14 * slow.distance_m);
      EXPECT_EQ(fast.inside, slow.inside);
      ASSERT_FALSE(testing::Test::HasFailure()) << name(family) << " " << i;
    }
  }
}

TEST(ExactTwin, RayTriangle) { compare_rays(kTriangle, 11); }
TEST(ExactTwin, RaySphere) { compare_rays(kSphere, 12); }
TEST(ExactTwin, RayBox) { compare_rays(kBox, 13); }
TEST(ExactTwin, RayCapsule) { compare_rays(kCapsule, 14); }

template <class MakeA, class MakeB>
void compare_pairs(MakeA make_a, MakeB make_b, std::uint64_t seed) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const oracle::Family family : oracle::kFamilies) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 100; ++i) {
      const auto a = make_a(shapes);
      const auto b = make_b(shapes);
      ASSERT_EQ(exactly::overlaps(a, b), overlaps(a, b).decision) << name(family) << " " << i;
    }
  }
}

TEST(ExactTwin, SphereSphere) { compare_pairs(kSphere, kSphere, 21); }
TEST(ExactTwin, SphereBox) { compare_pairs(kSphere, kBox, 22); }
TEST(ExactTwin, SphereCapsule) { compare_pairs(kSphere, kCapsule, 23); }
TEST(ExactTwin, SphereTriangle) { compare_pairs(kSphere, kTriangle, 24); }
TEST(ExactTwin, BoxBox) { compare_pairs(kBox, kBox, 25); }
TEST(ExactTwin, BoxCapsule) { compare_pairs(kBox, kCapsule, 26); }
TEST(ExactTwin, BoxTriangle) { compare_pairs(kBox, kTriangle, 27); }
TEST(ExactTwin, CapsuleCapsule) { compare_pairs(kCapsule, kCapsule, 28); }
TEST(ExactTwin, CapsuleTriangle) { compare_pairs(kCapsule, kTriangle, 29); }
TEST(ExactTwin, TriangleTriangle) { compare_pairs(kTriangle, kTriangle, 30); }

TEST(ExactTwin, PrimitivesInAnyOrder) {
  const Primitive box = Box{{0, 0, 0}, Mat3::Identity(), {1, 1, 1}};
  const Primitive pill = Capsule{{2, 0, 0}, {4, 0, 0}, 1};
  EXPECT_EQ(exactly::overlaps(box, pill), Decision::yes);
  EXPECT_EQ(exactly::overlaps(pill, box), Decision::yes);
  EXPECT_EQ(exactly::overlaps(pill, Triangle{{5, 0, -1}, {5, 0, 1}, {6, 0, 0}}), Decision::yes);
  RayHit hit;
  EXPECT_EQ(exactly::cast_ray({{-3, 0, 0}, {1, 0, 0}}, pill, hit), Decision::yes);
  EXPECT_EQ(hit.distance_m, 4);
}

template <class Make>
void compare_closest(Make make, std::uint64_t seed) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const oracle::Family family : oracle::kFamilies) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 200; ++i) {
      const auto shape = make(shapes);
      const Vec3 point = shapes.point();
      const Closest fast = closest(point, shape);
      const Closest slow = exactly::closest(point, shape);
      expect_same(fast.distance_m, fast.distance_error_m, slow.distance_m, slow.distance_error_m);
      ASSERT_FALSE(testing::Test::HasFailure()) << name(family) << " " << i;
    }
  }
}

TEST(ExactTwin, ClosestOnSphere) { compare_closest(kSphere, 41); }
TEST(ExactTwin, ClosestOnBox) { compare_closest(kBox, 42); }
TEST(ExactTwin, ClosestOnCapsule) { compare_closest(kCapsule, 43); }
TEST(ExactTwin, ClosestOnTriangle) { compare_closest(kTriangle, 44); }

// A thread that was told to spend little still audits with everything.
TEST(ExactTwin, ThePrecisionOfTheThreadIsNotAsked) {
  const PrecisionScope scope({Level::filter, 1.0});
  const Sphere a{{0.1, 0.2, 0.3}, 0.5};
  const Sphere b{{0.1, 0.2, 1.3}, 0.5};
  EXPECT_EQ(overlaps(a, b).decision, Decision::undecided);
  EXPECT_NE(exactly::overlaps(a, b), Decision::undecided);
}

}  // namespace
}  // namespace collided::engine::twin_test
