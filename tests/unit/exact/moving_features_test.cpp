#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/motion/moving_features.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "tests/oracle/moving_data.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::moving_features_test {
namespace {

using oracle::MovingQuery;

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

// On its way to a solid the ball touches it at the time 1/2: no bracket may end before, however narrow.
TEST(ExactMovingBall, NoBracketEndsBeforeABallTouchesACurvedSolid) {
  for (const double far : {0.0, 1e3, 1e6}) {
    const MovingSphere ball{.start = {far - 10, 0, 0}, .end = {far + 6, 0, 0}, .radius_m = 1};
    const auto expect_half = [&](const auto& solid, const char* kind) {
      for (const double width : {0.0, 1e-15, 1e-12, 1e-6}) {
        TimeBracket bracket;
        const ExactResult verdict = first_contact(ball, solid, width, bracket);
        ASSERT_NE(verdict.decision, Decision::no) << kind;
        if (!verdict.yes()) continue;
        EXPECT_GE(bracket.high, 0.5) << kind << ' ' << far << ' ' << width;
        EXPECT_LE(bracket.low, 0.5) << kind << ' ' << far << ' ' << width;
      }
    };
    expect_half(Cylinder{.a = {far, 0, -3}, .b = {far, 0, 5}, .radius_m = 1}, "cylinder");
    expect_half(Ellipsoid{.center = {far, 0, 0}, .half_m = {1, 2, 3}}, "ellipsoid");
    expect_half(Cone{.apex = {far - 1, 0, 0}, .base = {far + 4, 0, 0}, .radius_m = 1}, "cone");
  }
}

MovingPoint at_rest(const Vec3& p) { return {p, p}; }

/// In the plane z = 0, with (1/4, 1/4) well inside.
MovingTriangle resting_floor() { return {at_rest({0, 0, 0}), at_rest({1, 0, 0}), at_rest({0, 1, 0})}; }

/// The first time is in (low, high], or at the start; `truth` holds it too. One holds the other: overlapping by an end
/// would let an answer pass that is one double off.
void expect_holds(const TimeBracket& bracket, const TimeBracket& truth, const std::string& name) {
  if (truth.high == 0) {
    EXPECT_EQ(bracket.low, 0) << name;
    EXPECT_EQ(bracket.high, 0) << name;
    return;
  }
  const bool wider = bracket.low <= truth.low && bracket.high >= truth.high;
  const bool sharper = bracket.low >= truth.low && bracket.high <= truth.high;
  EXPECT_TRUE(wider || sharper) << name << ": " << bracket.low << " to " << bracket.high;
  if (truth.low == truth.high) { EXPECT_LT(bracket.low, truth.low) << name; }
}

void expect_at(const ExactResult& verdict, const TimeBracket& bracket, double truth) {
  ASSERT_EQ(verdict.decision, Decision::yes);
  expect_holds(bracket, {truth, truth}, "at " + std::to_string(truth));
  EXPECT_LE(bracket.high - bracket.low, 4 * kEpsilon * truth);
}

struct Count {
  int asked = 0;
  int missed = 0;
  int false_hits = 0;
  int undecided = 0;
  int rational = 0;
};

Count judge(const std::vector<MovingQuery>& queries, double width) {
  Count count;
  for (const MovingQuery& query : queries) {
    TimeBracket bracket;
    const ExactResult verdict = oracle::ask(query, width, bracket);
    ++count.asked;
    count.missed += query.hit && verdict.decision == Decision::no;
    count.false_hits += !query.hit && verdict.yes();
    count.undecided += verdict.decision == Decision::undecided;
    count.rational += verdict.level == Level::rational;
    if (!query.timed || !verdict.yes()) continue;
    expect_holds(bracket, query.truth, query.name);
    EXPECT_LE(bracket.high - bracket.low, std::max(width, 4 * kEpsilon * query.truth.high)) << query.name;
  }
  std::printf("width %g: %d asked, %d missed, %d false, %d undecided, %d by rationals\n", width, count.asked,
              count.missed, count.false_hits, count.undecided, count.rational);
  EXPECT_EQ(count.missed + count.false_hits + count.undecided, 0);
  return count;
}

TEST(ExactMovingFeatures, PublishedQueriesAreAllDecidedRight) {
  int not_doubles = 0;
  const auto queries = oracle::rational_queries(not_doubles);
  if (queries.empty()) GTEST_SKIP() << "no exact data";
  EXPECT_EQ(not_doubles, 0);
  EXPECT_EQ(queries.size(), 2824u);
  judge(queries, 1e-6);
}

TEST(ExactMovingFeatures, BracketsHoldThePublishedTimes) {
  const auto queries = oracle::timed_queries();
  if (queries.empty()) GTEST_SKIP() << "no exact data";
  EXPECT_EQ(queries.size(), 4894u);
  judge(queries, 1e-6);
  judge(queries, 0);
}

/// Contact is one of sets: the order in which their corners are named, and which is called the first, change no bit of
/// the decision and leave the truth in the bracket.
TEST(ExactMovingFeatures, NamingThePointsDifferentlyChangesNothing) {
  std::vector<MovingQuery> queries = oracle::timed_queries();
  if (queries.empty()) GTEST_SKIP() << "no exact data";
  std::mt19937_64 generator = oracle::seeded(4711);
  for (MovingQuery& query : queries) {
    if (query.edge_edge) {
      if (generator() % 2) std::swap(query.point[0], query.point[1]);
      if (generator() % 2) std::swap(query.point[2], query.point[3]);
      if (generator() % 2) std::rotate(query.point.begin(), query.point.begin() + 2, query.point.end());
    } else {
      std::shuffle(query.point.begin() + 1, query.point.end(), generator);
    }
    const int turn = static_cast<int>(generator() % 3);
    for (MovingPoint& p : query.point) {
      for (Vec3* v : {&p.start, &p.end}) {
        const Vec3 before = *v;
        for (int k = 0; k < 3; ++k) (*v)[k] = before[(k + turn) % 3];
      }
    }
  }
  judge(queries, 1e-9);
}

TEST(ExactMovingFeatures, APointFallsOnTheFloorAtHalfTime) {
  const MovingPoint point{{0.25, 0.25, 1}, {0.25, 0.25, -1}};
  TimeBracket bracket;
  expect_at(first_contact(point, resting_floor(), 0, bracket), bracket, 0.5);
}

TEST(ExactMovingFeatures, APointReachesTheFloorAtTheVeryEndOrNot) {
  TimeBracket bracket;
  expect_at(first_contact(MovingPoint{{0.25, 0.25, 1}, {0.25, 0.25, 0}}, resting_floor(), 0, bracket), bracket, 1);
  const MovingPoint short_of_it{{0.25, 0.25, 1}, {0.25, 0.25, 0x1p-1074}};
  EXPECT_EQ(first_contact(short_of_it, resting_floor(), 0, bracket).decision, Decision::no);
}

TEST(ExactMovingFeatures, ContactAtTheStartIsZeroZero) {
  TimeBracket bracket{0.5, 0.5};
  for (const Vec3& away : {Vec3(0, 0, 1), Vec3(0, 0, 0), Vec3(-1, -1, 0)}) {
    for (const Vec3& from : {Vec3(0.25, 0.25, 0), Vec3(0, 0, 0), Vec3(0.5, 0.5, 0)}) {
      ASSERT_TRUE(first_contact(MovingPoint{from, from + away}, resting_floor(), 1e-6, bracket).yes());
      EXPECT_EQ(bracket.low, 0);
      EXPECT_EQ(bracket.high, 0);
    }
  }
}

/// A face that tips over and a point that flies along it: at s = 2t - 1 the plane stands at -(s + s^2) / 2 under the
/// point, the point itself at k - s / 2; so it is s^2 / 2 + k above, and never near an edge but at the ends.
ExactResult over_tipping_face(double k, TimeBracket& bracket) {
  const MovingTriangle face{{{0, -4, 1}, {0, -4, -1}}, {{0, 4, 1}, {0, 4, -1}}, at_rest({4, 0, 0})};
  return first_contact(MovingPoint{{4, 0, 0.5 + k}, {0, 0, -0.5 + k}}, face, 0, bracket);
}

TEST(ExactMovingFeatures, ATangentTouchIsFoundAndOneRoundingOffIsNot) {
  TimeBracket bracket;
  expect_at(over_tipping_face(0, bracket), bracket, 0.5);
  EXPECT_EQ(over_tipping_face(0x1p-53, bracket).decision, Decision::no);
}

TEST(ExactMovingFeatures, TheEarliestOfTwoCrossingsIsTold) {
  TimeBracket bracket;
  expect_at(over_tipping_face(-0.125, bracket), bracket, 0.25);
}

TEST(ExactMovingFeatures, CrossingsALittleApartAreToldApart) {
  TimeBracket bracket;
  expect_at(over_tipping_face(-0x1p-53, bracket), bracket, 0.5 - 0x1p-27);
}

TEST(ExactMovingFeatures, ATriangleThatCollapsesInMidStepStillStopsThePoint) {
  // At half time the face is the segment from (-1,0,0) to (1,0,0).
  const MovingTriangle face{at_rest({-1, 0, 0}), at_rest({1, 0, 0}), {{0, 1, 0}, {0, -1, 0}}};
  TimeBracket bracket;
  expect_at(first_contact(MovingPoint{{0.5, 0, 1}, {0.5, 0, -1}}, face, 0, bracket), bracket, 0.5);
  EXPECT_EQ(first_contact(MovingPoint{{1.5, 0, 1}, {1.5, 0, -1}}, face, 0, bracket).decision, Decision::no);
}

TEST(ExactMovingFeatures, ATriangleThatShrinksToAPointMeetsAPoint) {
  const MovingTriangle face{{{0, 0, 0}, {1, 1, 1}}, {{3, 0, 0}, {1, 1, 1}}, {{0, 3, 0}, {1, 1, 1}}};
  TimeBracket bracket;
  expect_at(first_contact(MovingPoint{{1, 1, 3}, {1, 1, 1}}, face, 0, bracket), bracket, 1);
  EXPECT_EQ(first_contact(MovingPoint{{1, 1, 3}, {1, 1, 1 + kEpsilon}}, face, 0, bracket).decision, Decision::no);
}

TEST(ExactMovingFeatures, APointThatStaysInThePlaneEntersOverAnEdge) {
  TimeBracket bracket;
  expect_at(first_contact(MovingPoint{{-1, 0.25, 0}, {3, 0.25, 0}}, resting_floor(), 0, bracket), bracket, 0.25);
  const MovingPoint summand{{-1, -kEpsilon, 0}, {3, -kEpsilon, 0}};
  EXPECT_EQ(first_contact(summand, resting_floor(), 0, bracket).decision, Decision::no);
}

TEST(ExactMovingFeatures, APointAlongTheLineOfAnEdgeMeetsItsEnd) {
  TimeBracket bracket;
  expect_at(first_contact(MovingPoint{{-1, 0, 0}, {3, 0, 0}}, resting_floor(), 0, bracket), bracket, 0.25);
}

TEST(ExactMovingFeatures, SegmentsOnOneLineMeetEndToEnd) {
  const MovingSegment rest{at_rest({0, 0, 0}), at_rest({1, 1, 1})};
  const MovingSegment comes{{{4, 4, 4}, {0, 0, 0}}, {{6, 6, 6}, {2, 2, 2}}};
  TimeBracket bracket;
  expect_at(first_contact(rest, comes, 0, bracket), bracket, 0.75);
}

TEST(ExactMovingFeatures, PointsAsSegmentsMeetOnlyWhereTheyAreOne) {
  const MovingPoint left{{-1, 0, 0}, {1, 0, 0}};
  const MovingPoint right{{3, 0, 0}, {-1, 0, 0}};
  TimeBracket bracket;
  const ExactResult verdict = first_contact(MovingSegment{left, left}, MovingSegment{right, right}, 0, bracket);
  ASSERT_TRUE(verdict.yes());
  // -1 + 2t = 3 - 4t: two thirds, not a double.
  EXPECT_EQ(bracket.low, 2.0 / 3);  // which is less than two thirds
  EXPECT_EQ(bracket.high, std::nextafter(2.0 / 3, 1.0));
  const MovingPoint summand{{3, 0, 0x1p-300}, {-1, 0, 0x1p-300}};
  EXPECT_EQ(first_contact(MovingSegment{left, left}, MovingSegment{summand, summand}, 0, bracket).decision,
            Decision::no);
}

TEST(ExactMovingFeatures, EqualGreatSpeedsLeaveASmallOneExact) {
  const Vec3 fast(0x1p30, -0x1p30, 0x1p30);
  MovingTriangle floor = resting_floor();
  for (MovingPoint* p : {&floor.a, &floor.b, &floor.c}) p->end += fast;
  const double slow = 0x1p-20;
  TimeBracket bracket;
  const MovingPoint point{{0.25, 0.25, slow}, Vec3(0.25, 0.25, -slow) + fast};
  expect_at(first_contact(point, floor, 0, bracket), bracket, 0.5);
}

TEST(ExactMovingFeatures, AnyScaleGivesTheSameTimes) {
  for (const double scale : {0x1p-1000, 0x1p-300, 0x1p-40, 0x1p40, 0x1p300, 0x1p1000}) {
    MovingTriangle floor = resting_floor();
    for (MovingPoint* p : {&floor.a, &floor.b, &floor.c}) p->start *= scale, p->end *= scale;
    const MovingPoint point{scale * Vec3(0.25, 0.25, 1), scale * Vec3(0.25, 0.25, -3)};
    TimeBracket bracket;
    expect_at(first_contact(point, floor, 0, bracket), bracket, 0.25);
  }
}

TEST(ExactMovingFeatures, ATinyStepIsAStep) {
  TimeBracket bracket;
  const MovingPoint point{{0.25, 0.25, 0x1p-1000}, {0.25, 0.25, 0}};
  expect_at(first_contact(point, resting_floor(), 0, bracket), bracket, 1);
  // Fast, and there almost at once.
  const MovingPoint bullet{{0.25, 0.25, 0x1p-1000}, {0.25, 0.25, 0x1p-1000 - 0x1p20}};
  ASSERT_TRUE(first_contact(bullet, resting_floor(), 0, bracket).yes());
  EXPECT_LT(bracket.low, 0x1p-1020);
  EXPECT_GE(bracket.high, 0x1p-1020);
}

TEST(ExactMovingFeatures, WhatIsNotFiniteIsUndecided) {
  const double inf = std::numeric_limits<double>::infinity();
  TimeBracket bracket;
  for (const double bad : {inf, -inf, std::nan("")}) {
    const MovingPoint lost{{0, 0, 9}, {0, 0, bad}};
    EXPECT_EQ(first_contact(lost, resting_floor(), 0, bracket).decision, Decision::undecided);
    MovingTriangle bent = resting_floor();
    bent.c.end[1] = bad;
    EXPECT_EQ(first_contact(bent, resting_floor(), 0, bracket).decision, Decision::undecided);
  }
}

TEST(ExactMovingFeatures, WhereRationalsAreForbiddenADoubtStaysOne) {
  const PrecisionScope scope({Level::filter, 0});
  TimeBracket bracket;
  const MovingPoint on_a_corner{{0, 0, 1}, {0, 0, -1}};
  EXPECT_EQ(first_contact(on_a_corner, resting_floor(), 0, bracket).decision, Decision::undecided);
}

}  // namespace
}  // namespace collided::engine::moving_features_test
