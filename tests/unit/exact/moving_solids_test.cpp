#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "server/exact_phase/motion/moving_features.hpp"
#include "server/exact_phase/motion/moving_solids.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::moving_solids_test {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

Triangle wall_at(double x) { return {{x, -9, -9}, {x, 9, -9}, {x, 0, 9}}; }

Translated<Box> unit_box(const Vec3& displacement) {
  return {.start = {.center = {0, 0, 0}, .half_m = {1, 1, 1}}, .from = {0, 0, 0}, .to = displacement};
}

TEST(ExactMovingSolids, ABoxReachesAWallWhereItsFaceDoes) {
  TimeBracket bracket;
  ASSERT_TRUE(first_contact(unit_box({8, 0, 0}), wall_at(3), 0, bracket).yes());
  EXPECT_LT(bracket.low, 0.25);
  EXPECT_EQ(bracket.high, 0.25);
  EXPECT_EQ(first_contact(unit_box({8, 0, 0}), wall_at(9 + 8 * kEpsilon * 2), 0, bracket).decision, Decision::no);
  EXPECT_TRUE(first_contact(unit_box({8, 0, 0}), wall_at(9), 0, bracket).yes());
}

TEST(ExactMovingSolids, ABulletOfABoxDoesNotPassThroughASheet) {
  Translated<Box> bullet = unit_box({0x1p20, 0, 0});
  bullet.start.half_m *= 0x1p-10;
  TimeBracket bracket;
  ASSERT_TRUE(first_contact(bullet, wall_at(0x1p19), 1e-9, bracket).yes());
  EXPECT_LT(bracket.low, 0.5 - 0x1p-30);
  EXPECT_GE(bracket.high, 0.5 - 0x1p-30);
}

TEST(ExactMovingSolids, ABoxThatTouchesAtRestDoesSoFromTheStart) {
  TimeBracket bracket;
  for (const Vec3& displacement : {Vec3(0, 0, 0), Vec3(-1, 0, 0), Vec3(0, 3, 0)}) {
    ASSERT_TRUE(first_contact(unit_box(displacement), wall_at(1), 0, bracket).yes());
    EXPECT_EQ(bracket.high, 0);
  }
  // A triangle wholly inside a solid touches it.
  ASSERT_TRUE(first_contact(unit_box({1, 0, 0}), {{0, 0, 0}, {0.5, 0, 0}, {0, 0.5, 0}}, 0, bracket).yes());
  EXPECT_EQ(bracket.high, 0);
}

TEST(ExactMovingSolids, ACapsuleReachesAWallWithItsRound) {
  const Translated<Capsule> mover{.start = {{0, 0, 0}, {-1, 0, 0}, 0.5}, .from = {0, 0, 0}, .to = {4, 0, 0}};
  TimeBracket bracket;
  ASSERT_TRUE(first_contact(mover, wall_at(2.5), 0, bracket).yes());
  EXPECT_LT(bracket.low, 0.5);
  EXPECT_EQ(bracket.high, 0.5);
  EXPECT_EQ(first_contact(mover, wall_at(4.5 + 4 * kEpsilon), 0, bracket).decision, Decision::no);
}

double on_grid(double x) { return std::round(x * 1024) / 1024; }

/// Places with ten binary digits, so that times of 2^-14 give doubles.
class Grid {
 public:
  explicit Grid(std::mt19937_64& generator) : generator_(generator) {}
  double value(double most) { return on_grid(std::uniform_real_distribution<double>(-most, most)(generator_)); }
  Vec3 point(double most) { return {value(most), value(most), value(most)}; }
  Triangle triangle() {
    const Vec3 at = point(2);
    return {at + point(1), at + point(1), at + point(1)};
  }

 private:
  std::mt19937_64& generator_;
};

/// The box's sides are exact here, and so is each corner's way: the surface is twelve moving triangles.
struct Surface {
  std::array<MovingTriangle, 12> triangle;

  explicit Surface(const Translated<Box>& mover) {
    const auto corner = [&](int i) {
      const Vec3 sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      const Vec3 start = mover.start.center + sign.cwiseProduct(mover.start.half_m);
      return MovingPoint{start, start + (mover.to - mover.from)};
    };
    constexpr int kFaces[6][4] = {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}};
    for (int f = 0; f < 6; ++f) {
      const int* c = kFaces[f];
      triangle[2 * f] = {corner(c[0]), corner(c[1]), corner(c[2])};
      triangle[2 * f + 1] = {corner(c[0]), corner(c[2]), corner(c[3])};
    }
  }
};

MovingTriangle at_rest(const Triangle& t) { return {{t.a, t.a}, {t.b, t.b}, {t.c, t.c}}; }

TEST(ExactMovingSolids, ABoxAnswersAsTheTrianglesOfItsSurface) {
  std::mt19937_64 generator = oracle::seeded(51);
  Grid grid(generator);
  int hits = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 from = grid.point(2);
    const Box box{.center = from, .half_m = grid.point(1).cwiseAbs()};
    const Translated<Box> mover{box, from, grid.point(2)};
    const Triangle other = grid.triangle();
    TimeBracket bracket;
    const ExactResult verdict = first_contact(mover, other, 1e-9, bracket);
    if (overlaps(box, other).yes()) {
      ASSERT_TRUE(verdict.yes());
      ASSERT_EQ(bracket.high, 0);
      continue;
    }
    TimeBracket first{1, 1};
    bool any = false;
    for (const MovingTriangle& part : Surface(mover).triangle) {
      TimeBracket own;
      if (!first_contact(part, at_rest(other), 1e-9, own).yes()) continue;
      any = true;
      if (own.high < first.high) first = own;
    }
    ASSERT_EQ(verdict.decision, any ? Decision::yes : Decision::no);
    if (!any) continue;
    ++hits;
    ASSERT_LE(bracket.low, first.high);
    ASSERT_GE(bracket.high, first.low);
    ASSERT_LE(bracket.high - bracket.low, 1e-9);
  }
  EXPECT_GT(hits, 20);
}

TEST(ExactMovingSolids, ACapsuleWithoutRadiusAnswersAsAMovingSegment) {
  std::mt19937_64 generator = oracle::seeded(52);
  Grid grid(generator);
  int hits = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 from = grid.point(1);
    const Translated<Capsule> mover{{from + grid.point(1), from + grid.point(1), 0}, from, grid.point(2)};
    const Vec3 displacement = mover.to - mover.from;
    const MovingPoint a{mover.start.a, mover.start.a + displacement};
    const MovingPoint b{mover.start.b, mover.start.b + displacement};
    const Triangle other = grid.triangle();
    TimeBracket bracket;
    TimeBracket twin;
    const ExactResult verdict = first_contact(mover, other, 1e-9, bracket);
    ASSERT_EQ(verdict.decision, first_contact(MovingTriangle{a, b, b}, at_rest(other), 1e-9, twin).decision);
    if (!verdict.yes()) continue;
    ++hits;
    ASSERT_LE(bracket.low, twin.high);
    ASSERT_GE(bracket.high, twin.low);
  }
  EXPECT_GT(hits, 20);
}

TEST(ExactMovingSolids, SamplingFindsACapsuleNowhereBeforeItsFirstContact) {
  std::mt19937_64 generator = oracle::seeded(53);
  Grid grid(generator);
  constexpr int kSamples = 1024;
  int hits = 0;
  for (int sweep = 0; sweep < 300; ++sweep) {
    const Vec3 from = grid.point(1);
    const Capsule capsule{from + grid.point(1), from + grid.point(1), std::abs(grid.value(0.5))};
    const Translated<Capsule> mover{capsule, from, grid.point(2)};
    const Triangle other = grid.triangle();
    TimeBracket bracket;
    const ExactResult verdict = first_contact(mover, other, 1e-6, bracket);
    hits += verdict.yes();
    const auto meets_at = [&](int i) {
      const Vec3 gone = static_cast<double>(i) / kSamples * (mover.to - mover.from);
      return overlaps(Capsule{capsule.a + gone, capsule.b + gone, capsule.radius_m}, other).yes();
    };
    if (verdict.yes() && bracket.high == 0) {
      ASSERT_TRUE(meets_at(0));
      continue;
    }
    const int clear = verdict.yes() ? static_cast<int>(std::floor(bracket.low * kSamples)) : kSamples;
    for (int i = 0; i <= clear; ++i) ASSERT_FALSE(meets_at(i)) << "sweep " << sweep << " at " << i;
  }
  EXPECT_GT(hits, 20);
}

}  // namespace
}  // namespace collided::engine::moving_solids_test
