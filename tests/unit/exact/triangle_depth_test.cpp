// What plain double tells of the contact of two triangles, beside the contact itself.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/triangle_depth.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/part.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::triangle_depth_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Calls visit(a, b, contact) for pairs of overlapping triangles of every family.
template <class Visit>
void visit_contacts(std::uint64_t seed, const Visit& visit) {
  std::mt19937_64 generator = oracle::seeded(seed);
  for (const oracle::Family family : oracle::kFamilies) {
    SCOPED_TRACE(oracle::name(family));
    oracle::RandomShapes random(generator, family);
    for (int i = 0; i < 3000; ++i) {
      const Triangle a = random.triangle();
      const Triangle b = random.triangle();
      if (overlaps(a, b).yes()) visit(family, a, b, contact(a, b));
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(TriangleDepth, TheBoundIsNotBelowTheDepth) {
  int pairs = 0;
  int tight = 0;
  int usual = 0;
  visit_contacts(20261129, [&](oracle::Family family, const Triangle& a, const Triangle& b, const Contact& found) {
    const double bound_m = kernel::depth_at_most(a, b, -kInfinity);
    ASSERT_GE(bound_m, found.depth_m) << std::hexfloat << bound_m << ' ' << found.depth_m;
    // Ended early, it still is a bound.
    ASSERT_GE(kernel::depth_at_most(a, b, kInfinity), bound_m);
    ++pairs;
    if (family != oracle::Family::random) return;
    ++usual;
    tight += bound_m <= found.depth_m * (1 + 1e-6) ? 1 : 0;
  });
  EXPECT_GT(pairs, 2000);
  EXPECT_GT(tight, usual * 9 / 10) << "a bound that is always far too large would spare nothing";
}

TEST(TriangleDepth, ASureNormalIsThatOfTheContact) {
  int known = 0;
  int usual = 0;
  visit_contacts(20261130, [&](oracle::Family family, const Triangle& a, const Triangle& b, const Contact& found) {
    const std::optional<Vec3> quick = kernel::sure_normal(a, b);
    usual += family == oracle::Family::random ? 1 : 0;
    if (!quick) return;
    ASSERT_LT((*quick - found.normal).norm(), kernel::kSureNormal)
        << quick->transpose() << " for " << found.normal.transpose();
    known += family == oracle::Family::random ? 1 : 0;
  });
  EXPECT_GT(known, usual * 9 / 10);
}

TEST(TriangleDepth, TheGapIsNotAboveTheDistance) {
  std::mt19937_64 generator = oracle::seeded(20261205);
  int apart = 0;
  int told = 0;
  for (const oracle::Family family : oracle::kFamilies) {
    SCOPED_TRACE(oracle::name(family));
    oracle::RandomShapes random(generator, family);
    for (int i = 0; i < 3000; ++i) {
      const Triangle a = random.triangle();
      const Triangle b = random.triangle();
      const double gap_m = kernel::gap_at_least(a, b);
      if (overlaps(a, b).yes()) {
        ASSERT_EQ(gap_m, 0) << i;
        continue;
      }
      const Separation true_gap = separation(ConvexPart(a), ConvexPart(b));
      ASSERT_LE(gap_m, true_gap.distance_m + true_gap.error_m) << i;
      ++apart;
      told += gap_m > true_gap.distance_m / 2 ? 1 : 0;
    }
  }
  EXPECT_GT(told, apart / 2) << "a bound of nothing would rule out nothing";
}

// Two pushes that are equal leave the axis open, and two ways along one its sign: nothing is then said.
TEST(TriangleDepth, ATieIsNotSure) {
  const Triangle level{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  const Triangle upright{{0, 0, -0.25}, {0.1, 0.04, 0.25}, {-0.1, -0.02, 0.1875}};
  EXPECT_FALSE(kernel::sure_normal(level, upright)) << "up or down is as near";
  Triangle lifted = upright;
  for (Vec3* corner : {&lifted.a, &lifted.b, &lifted.c}) (*corner)[2] += 0.125;
  const std::optional<Vec3> up = kernel::sure_normal(level, lifted);
  ASSERT_TRUE(up.has_value());
  EXPECT_GT(up->z(), 0.99);
}

}  // namespace
}  // namespace collided::engine::triangle_depth_test
