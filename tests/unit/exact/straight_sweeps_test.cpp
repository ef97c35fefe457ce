#include <gtest/gtest.h>

#include <cstdio>
#include <random>

#include "server/exact_phase/motion/ground_motion.hpp"
#include "server/exact_phase/motion/part_motion.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/plane_reach.hpp"
#include "tests/oracle/random_shapes.hpp"
#include "tests/oracle/seed.hpp"

// Straight ways that end a hair before a face, on it or a hair behind it, against where the solid is then in rationals.

namespace collided::engine::straight_sweeps_test {
namespace {

using namespace oracle;

Vec3 random_direction(std::mt19937_64& generator) {
  std::normal_distribution<double> any;
  return Vec3(any(generator), any(generator), any(generator)).normalized();
}

/// A wide triangle under the solid's lowest point against n, its plane as exact numbers.
struct Floor {
  Triangle face;
  Point up;
  Rational height;

  Floor(const Vec3& foot, const Vec3& n) {
    const auto [u, v] = across(n);
    face = {foot + 40 * u, foot - 40 * u + 40 * v, foot - 40 * u - 40 * v};
    const Point corner = exact(face.a);
    up = cross(minus(exact(face.b), corner), minus(exact(face.c), corner));
    if (dot(up, exact(n)) < 0) up = times(-1, up);
    height = dot(up, corner);
  }
  /// Of the solid when it has gone the way's share t.
  bool is_reached(const Primitive& start, const Vec3& from, const Vec3& to, const Rational& t) const {
    const Point motion = times(t, minus(exact(to), exact(from)));
    const Point down = times(-1, up);
    return reaches_past(start, down, Rational(-height - dot(down, motion))) >= 0;
  }
};

struct Tally {
  int reached = 0;
  int missed = 0;
  int exact = 0;
};

/// `own` goes from `from` to `to`; the floor is what it nearly comes to.
void check(const Primitive& own, const Vec3& from, const Vec3& to, const Floor& floor, const BoundedPart& other,
           Tally& tally) {
  const Primitive start = place(Frame{Mat3::Identity(), from}, own);
  ASSERT_FALSE(floor.is_reached(start, from, to, 0));
  const bool truth = floor.is_reached(start, from, to, 1);
  const BodyMotion motion({Mat3::Identity(), from}, {Mat3::Identity(), to});
  const BodyMotion rest = BodyMotion::resting({});
  for (const bool turned : {false, true}) {
    const PartMotion mover(part_of(own), motion);
    const PartMotion resting(other, rest);
    TimeBracket bracket;
    const ExactResult verdict =
        turned ? first_contact(resting, mover, {}, 1e-9, bracket) : first_contact(mover, resting, {}, 1e-9, bracket);
    ASSERT_EQ(verdict.decision, truth ? Decision::yes : Decision::no)
        << "solid " << own.index() << ", other " << other.index();
    tally.exact += verdict.level == Level::rational;
    ++(truth ? tally.reached : tally.missed);
    if (!truth) continue;
    ASSERT_LE(bracket.high - bracket.low, 1e-9);
    ASSERT_FALSE(floor.is_reached(start, from, to, Rational(bracket.low)) && bracket.low > 0);
    ASSERT_TRUE(floor.is_reached(start, from, to, Rational(bracket.high)) ||
                !floor.is_reached(start, from, to, Rational(bracket.low)));
  }
}

/// 13,440 sweeps: every kind of solid against a triangle and the face of a hull.
TEST(ExactStraightSweeps, AnEndAtAGapOfAHairIsDecidedToTheLastDigit) {
  std::mt19937_64 generator = seeded(30);
  Tally tally;
  for (const Family family : {Family::random, Family::lattice, Family::tenths}) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 140; ++i) {
      const Primitive own = shapes.solid(i % 7);
      const Vec3 n = i % 3 == 0 ? Vec3(Vec3::Unit(i % 2)) : random_direction(generator);
      const Vec3 to = shapes.point();
      const Primitive at_end = place(Frame{Mat3::Identity(), to}, own);
      const Vec3 from = to + 3 * n + 0.7 * random_direction(generator);
      for (const double gap_m : {0.0, 4.5e-16, -4.5e-16, 1e-15, 1e-14, -1e-14, 1e-13, 1e-12}) {
        const Vec3 foot = lowest(at_end, n) - gap_m * n;
        const Floor floor(foot, n);
        check(own, from, to, floor, floor.face, tally);
        check(own, from, to, floor, std::get<Hull>(tetrahedron(floor.face, n, foot - 5 * n)), tally);
        if (HasFatalFailure()) return;
      }
    }
  }
  std::printf("%d straight sweeps: %d reach, %d do not, %d by rationals; 0 wrong, 0 undecided\n",
              tally.reached + tally.missed, tally.reached, tally.missed, tally.exact);
  EXPECT_GT(tally.reached, 3000);
  EXPECT_GT(tally.missed, 5000);
  EXPECT_GT(tally.exact, 5000);
}

TEST(ExactStraightSweeps, AHalfSpaceIsComeToOrNot) {
  std::mt19937_64 generator = seeded(31);
  RandomShapes shapes(generator, Family::random);
  int reached = 0;
  for (int i = 0; i < 700; ++i) {
    const Primitive own = shapes.solid(i % 7);
    const Vec3 n = random_direction(generator);
    const Vec3 to = shapes.point();
    const Vec3 from = to + 3 * n + 0.7 * random_direction(generator);
    const Primitive start = place(Frame{Mat3::Identity(), from}, own);
    for (const double gap_m : {0.0, 4.5e-16, -4.5e-16, 1e-14, 1e-12}) {
      const HalfSpace ground{lowest(place(Frame{Mat3::Identity(), to}, own), n) - gap_m * n, n};
      const Point down = times(-1, exact(n));
      const Point motion = minus(exact(to), exact(from));
      const bool truth = reaches_past(start, down, Rational(dot(down, minus(exact(ground.point), motion)))) >= 0;
      const BodyMotion straight({Mat3::Identity(), from}, {Mat3::Identity(), to});
      TimeBracket bracket;
      const ExactResult verdict = first_contact(PartMotion(part_of(own), straight), ground, {}, 1e-9, bracket);
      // The placed end is what the collision step sees, and its rounding may touch where the way does not.
      if (verdict.level == Level::filter && verdict.yes() && !truth) continue;
      ASSERT_EQ(verdict.decision, truth ? Decision::yes : Decision::no) << "solid " << own.index() << ", gap " << gap_m;
      reached += truth;
    }
  }
  EXPECT_GT(reached, 500);
}

/// A ball that comes straight in meets what its last place touches.
TEST(ExactStraightSweeps, ABallThatStopsBesideARoundSolidTouchesItThereOrNowhere) {
  std::mt19937_64 generator = seeded(32);
  int touching = 0;
  int apart = 0;
  for (const Family family : {Family::random, Family::lattice}) {
    RandomShapes shapes(generator, family);
    for (int i = 0; i < 300; ++i) {
      const Primitive solid = shapes.solid(4 + i % 3);
      const Vec3 n = i % 2 == 0 ? random_direction(generator) : Vec3(Vec3::Unit(i % 3));
      for (const double gap_m : {0.0, 4.5e-16, 1e-15, 1e-14, 1e-13, 1e-12, -1e-14}) {
        // A cylinder without radius is a polytope; the others have one.
        const MovingSphere mover{
            .start = lowest(solid, n) - 4 * n, .end = lowest(solid, n) - (0.75 + gap_m) * n, .radius_m = 0.75};
        const Decision there = overlaps(Primitive(Sphere{mover.end, mover.radius_m}), solid).decision;
        ASSERT_NE(there, Decision::undecided);
        TimeBracket bracket;
        ASSERT_EQ(first_contact(mover, solid, 1e-9, bracket).decision, there)
            << "solid " << solid.index() << ", gap " << gap_m;
        ++(there == Decision::yes ? touching : apart);
      }
    }
  }
  EXPECT_GT(touching, 500);
  EXPECT_GT(apart, 1500);
}

}  // namespace
}  // namespace collided::engine::straight_sweeps_test
