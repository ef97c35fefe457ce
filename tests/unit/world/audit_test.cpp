#include <gtest/gtest.h>

#include <cmath>

#include "server/world/audit/audit.hpp"
#include "tests/oracle/mixed_world.hpp"
#include "tests/oracle/seed.hpp"

// The audit agrees with right answers and sees every kind of wrong one.
namespace collided::engine {
namespace {

using oracle::MixedWorld;

class WorldAudit : public ::testing::Test {
 protected:
  std::vector<double> numbers(QuestionKind kind) {
    const Vec3 p = mixed_.point(3);
    const Vec3 d = mixed_.point(3) - p;
    switch (kind) {
      case QuestionKind::ray: return {p.x(), p.y(), p.z(), d.x(), d.y(), d.z(), INFINITY};
      case QuestionKind::sphere: return {p.x(), p.y(), p.z(), 1};
      case QuestionKind::box: return {p.x(), p.y(), p.z(), 1, 0.5, 0.7, 1, 0, 0, 0};
      default: return {p.x(), p.y(), p.z(), INFINITY};
    }
  }
  void ask(QuestionKind kind, HitMode mode = HitMode::closest) {
    numbers_ = numbers(kind);
    question_ = {.kind = kind, .mode = mode, .max_hits = kind == QuestionKind::near ? 3U : 1'000U, .numbers = numbers_};
    state_ = (*mixed_).newest();
    answer(*state_, question_, given_, scratch_);
  }
  std::string verdict() { return audit(*state_, question_, given_); }

  std::mt19937_64 random_ = oracle::seeded(51);
  MixedWorld mixed_{random_};
  std::vector<double> numbers_;
  Questions question_;
  SnapshotRing::Lease state_;
  Answers given_;
  QueryScratch scratch_;
};

TEST_F(WorldAudit, RightAnswersPass) {
  for (int i = 0; i < 60; ++i) {
    for (const QuestionKind kind : kPlainQuestions) {
      ask(kind);
      ASSERT_EQ(verdict(), "");
    }
    for (const HitMode mode : {HitMode::any, HitMode::all}) {
      ask(QuestionKind::ray, mode);
      ASSERT_EQ(verdict(), "");
    }
  }
}

TEST_F(WorldAudit, AMissThatIsAHitIsSeen) {
  for (const QuestionKind kind : kPlainQuestions) {
    do ask(kind);
    while (given_.hits.empty());
    given_.answers[0] = Verdict::miss;
    given_.hits.clear();
    EXPECT_NE(verdict(), "") << name_of(kind);
  }
}

TEST_F(WorldAudit, AHitThatIsNoneIsSeen) {
  for (const QuestionKind kind : kPlainQuestions) {
    do ask(kind);
    while (given_.hits.empty());
    const AnswerHit stolen = given_.hits[0];
    if (kind == QuestionKind::near) {
      // Nearest of all there is; what it can't be is far.
      given_.hits[0].distance_m += 1;
    } else {
      numbers_[0] = 1e3;
      answer(*state_, question_, given_, scratch_);
      ASSERT_TRUE(given_.hits.empty());
      given_.answers[0] = Verdict::hit;
      given_.hits = {stolen};
    }
    EXPECT_NE(verdict(), "") << name_of(kind);
  }
}

TEST_F(WorldAudit, ADistanceOutsideItsBoundIsSeen) {
  for (const QuestionKind kind : {QuestionKind::ray, QuestionKind::near}) {
    for (const bool is_solid : {true, false}) {
      do ask(kind);
      while (given_.hits.empty() || given_.hits[0].is_at_start() ||
             is_solid != (given_.hits[0].triangle == kNoTriangle));
      const double told_m = given_.hits[0].distance_m;
      for (const double side : {1.0, -1.0}) {
        given_.hits[0].distance_m = told_m + side * (3 * given_.hits[0].error_m + 1e-14 * told_m);
        EXPECT_NE(verdict(), "") << name_of(kind) << " of " << (is_solid ? "a solid" : "a triangle");
      }
    }
  }
}

TEST_F(WorldAudit, AnotherTriangleOrObjectIsSeen) {
  do ask(QuestionKind::ray);
  while (given_.hits.empty() || given_.hits[0].triangle == kNoTriangle);
  given_.hits[0].triangle ^= 1;
  EXPECT_NE(verdict(), "");
}

TEST_F(WorldAudit, AnObjectTooFewIsSeen) {
  do ask(QuestionKind::sphere);
  while (given_.hits.size() < 2);
  given_.hits.pop_back();
  EXPECT_NE(verdict(), "");
}

TEST_F(WorldAudit, UndecidedClaimsNothing) {
  ask(QuestionKind::ray);
  given_.answers[0] = Verdict::undecided;
  given_.reasons[0] = UndecidedReason::deadline;
  given_.hits.clear();
  EXPECT_EQ(verdict(), "");
}

}  // namespace
}  // namespace collided::engine
