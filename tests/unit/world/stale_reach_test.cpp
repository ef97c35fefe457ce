// What a lost publisher's object may have reached since it was seen last is not called free.
#include "server/world/query/stale_reach.hpp"

#include <gtest/gtest.h>

#include <random>

#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/query/pair_report.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kStaleSecond = 1'000'000'000;

ObjectDefinition ball(const std::string& name, const Vec3& position, double radius_m = 0.5) {
  Shape shape;
  shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = radius_m});
  return {.name = name,
          .scene = {},
          .shape = shape,
          .pose = {.position = position},
          .filter = {},
          .moving = true,
          .lost_policy = LostPolicy::freeze,
          .publisher = 1};
}

/// A ball that went from `from` to `to` within a second, and whose publisher was lost then.
struct LostBall {
  LostBall(const Vec3& from, const Vec3& to) {
    id = std::get<ObjectId>(world.define(ball("lost", from)));
    step(10 * kStaleSecond);
    world.move(id, {.position = to}, 11 * kStaleSecond, false);
    step(11 * kStaleSecond);
    world.set_stale(id, true);
    step(11 * kStaleSecond);
  }
  void step(std::int64_t time_ns) { ASSERT_TRUE(world.step(time_ns, 1, {})); }
  Answers ask(QuestionKind kind, std::vector<double> numbers, HitMode mode = HitMode::closest,
              const ObjectInfo* mover = nullptr) {
    Answers answers;
    answer(*world.newest(), {.kind = kind, .mode = mode, .numbers = numbers, .mover = mover}, answers, scratch);
    return answers;
  }
  World world{WorldOptions{}};
  ObjectId id = 0;
  QueryScratch scratch;
};

void expect_stale(const Answers& answers) {
  EXPECT_EQ(answers.answers[0], Verdict::undecided);
  EXPECT_EQ(answers.reasons[0], UndecidedReason::stale_object);
}

// 1 m/s for 10 s and half a second: everything from -10.5 to 12.5 m and the ball's own half metre.
TEST(StaleReach, AMissWithinReachIsUndecidedAndOneBeyondIsNot) {
  LostBall lost({0, 0, 0}, {1, 0, 0});
  lost.step(21 * kStaleSecond);
  expect_stale(lost.ask(QuestionKind::ray, {-11.5 + 2, 5, -50, 0, 0, 1, 100}));
  EXPECT_EQ(lost.ask(QuestionKind::ray, {12.6, 0, -50, 0, 0, 1, 100}).answers[0], Verdict::miss);
  expect_stale(lost.ask(QuestionKind::ray, {0, 0, -50, 0, 0, 1, 40}));
  EXPECT_EQ(lost.ask(QuestionKind::ray, {0, 0, -50, 0, 0, 1, 38}).answers[0], Verdict::miss) << "the ray ends before";
  expect_stale(lost.ask(QuestionKind::sphere, {0, 0, 12, 1}));
  EXPECT_EQ(lost.ask(QuestionKind::sphere, {0, 0, 13, 1}).answers[0], Verdict::miss);
  expect_stale(lost.ask(QuestionKind::box, {0, 0, 12, 1, 1, 1, 1, 0, 0, 0}));
  EXPECT_EQ(lost.ask(QuestionKind::box, {0, 0, 13, 1, 1, 1, 1, 0, 0, 0}).answers[0], Verdict::miss);
  expect_stale(lost.ask(QuestionKind::near, {0, 0, 20, 9.1}));
  EXPECT_EQ(lost.ask(QuestionKind::near, {0, 0, 20, 8.9}).answers[0], Verdict::miss);
}

// Apart is where it cannot have come to the other; where it was when it was heard of last shows, and is marked.
TEST(StaleReach, APairIsApartOnlyWhereTheLostOneCannotHaveComeToTheOther) {
  LostBall lost({0, 0, 0}, {1, 0, 0});
  const ObjectId near = std::get<ObjectId>(lost.world.define(ball("near", {0, 0, 11.4})));
  const ObjectId far = std::get<ObjectId>(lost.world.define(ball("far", {0, 0, 14})));
  const ObjectId met = std::get<ObjectId>(lost.world.define(ball("met", {1.5, 0, 0})));
  lost.step(11 * kStaleSecond);
  EXPECT_EQ(report_pair(*lost.world.newest(), lost.id, near, {}).touches, Decision::no) << "no time has gone by";
  lost.step(21 * kStaleSecond);
  for (const bool turned : {false, true}) {
    const auto report = [&](ObjectId other) {
      return report_pair(*lost.world.newest(), turned ? other : lost.id, turned ? lost.id : other,
                         {.certificate = true});
    };
    EXPECT_EQ(report(near).touches, Decision::undecided);
    EXPECT_TRUE(report(near).is_stale);
    EXPECT_FALSE(report(near).proof);
    EXPECT_EQ(report(far).touches, Decision::no);
    EXPECT_TRUE(report(far).is_stale) << "its distance is of where it was";
    EXPECT_NEAR(report(far).separation.distance_m, std::sqrt(197.0) - 1, 1e-12);
    EXPECT_EQ(report(met).touches, Decision::yes);
    EXPECT_TRUE(report(met).is_stale);
  }
  EXPECT_FALSE(report_pair(*lost.world.newest(), near, far, {}).is_stale);
  LostBall still({1, 0, 0}, {1, 0, 0});
  const ObjectId summand = std::get<ObjectId>(still.world.define(ball("beside", {2.5, 0, 0})));
  still.step(21 * kStaleSecond);
  EXPECT_EQ(report_pair(*still.world.newest(), still.id, summand, {}).touches, Decision::no)
      << "what stood still is where it was";
  EXPECT_FALSE(report_pair(*still.world.newest(), still.id, summand, {}).is_stale);
}

TEST(StaleReach, TheReachGrowsWithTheAge) {
  LostBall lost({0, 0, 0}, {1, 0, 0});
  const std::vector<double> ray{5, 0, -50, 0, 0, 1, 100};
  EXPECT_EQ(lost.ask(QuestionKind::ray, ray).answers[0], Verdict::miss);
  lost.step(12 * kStaleSecond);
  EXPECT_EQ(lost.ask(QuestionKind::ray, ray).answers[0], Verdict::miss);
  lost.step(15 * kStaleSecond);
  expect_stale(lost.ask(QuestionKind::ray, ray));
  lost.world.set_stale(lost.id, false);
  lost.step(15 * kStaleSecond);
  EXPECT_EQ(lost.ask(QuestionKind::ray, ray).answers[0], Verdict::miss) << "its publisher is back";
}

TEST(StaleReach, WhatStoodStillIsWhereItWas) {
  LostBall lost({1, 0, 0}, {1, 0, 0});
  lost.step(1'000 * kStaleSecond);
  EXPECT_EQ(lost.ask(QuestionKind::ray, {5, 0, -50, 0, 0, 1, 100}).answers[0], Verdict::miss);
  const Answers hit = lost.ask(QuestionKind::ray, {1, 0, -50, 0, 0, 1, 100});
  EXPECT_EQ(hit.answers[0], Verdict::hit);
  EXPECT_EQ(hit.hits[0].flags & kHitStale, kHitStale);
}

// Hits stay where nothing could be nearer, or any will do; the nearest one is in doubt where it lies behind.
TEST(StaleReach, OnlyWhatCouldChangeIsInDoubt) {
  LostBall lost({0, 0, 0}, {1, 0, 0});
  static_cast<void>(lost.world.define(ball("wall", {0, 0, 30})));
  lost.step(21 * kStaleSecond);
  EXPECT_EQ(lost.ask(QuestionKind::ray, {0, 0, 50, 0, 0, -1, 100}).answers[0], Verdict::hit) << "the wall comes first";
  const Answers behind = lost.ask(QuestionKind::ray, {6, 0, -50, -6, 0, 80, 1'000});
  expect_stale(behind);
  ASSERT_EQ(behind.hit_counts[0], 1U) << "what is known is told";
  EXPECT_EQ(lost.ask(QuestionKind::ray, {6, 0, -50, -6, 0, 80, 1'000}, HitMode::any).answers[0], Verdict::hit);
  EXPECT_EQ(lost.ask(QuestionKind::sphere, {0, 0, 30, 25}).answers[0], Verdict::hit)
      << "it meets something in any case";
  Questions masked{.kind = QuestionKind::ray, .skip = "lost", .numbers = {}};
  const std::vector<double> ray{3, 0, -50, 0, 0, 1, 100};
  masked.numbers = ray;
  Answers answers;
  answer(*lost.world.newest(), masked, answers, lost.scratch);
  EXPECT_EQ(answers.answers[0], Verdict::miss) << "who does not ask about it need not care";
}

/// Numbers of a question near the origin.
std::vector<double> any_question_about(QuestionKind kind, std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-30, 30);
  std::uniform_real_distribution<double> size(0, 5);
  const auto point = [&] { return Vec3(coordinate(random), coordinate(random), coordinate(random)); };
  const Vec3 p = point();
  const Vec3 q = point();
  switch (kind) {
    case QuestionKind::ray: return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), 40 * size(random)};
    case QuestionKind::sphere: return {p.x(), p.y(), p.z(), size(random)};
    case QuestionKind::box: return {p.x(), p.y(), p.z(), size(random), size(random), size(random), 0.6, 0, 0.8, 0};
    case QuestionKind::near: return {p.x(), p.y(), p.z(), 4 * size(random)};
    default: return {p.x(), p.y(), p.z(), 1, 0, 0, 0, q.x(), q.y(), q.z(), 0.6, 0, 0.8, 0};
  }
}

// The slow twin puts the ball to many places that it can have reached: wherever that changes an answer, the answer given
// without knowing was in doubt.
TEST(StaleReach, NoPlaceWithinReachContradictsWhatWasAnswered) {
  std::mt19937_64 random = oracle::seeded(41);
  std::normal_distribution<double> normal;
  Shape shape;
  shape.primitives.emplace_back(Sphere{.center = {0, 0, 0}, .radius_m = 1});
  const ObjectInfo mover = without_world(shape);
  constexpr QuestionKind kKinds[] = {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box, QuestionKind::near,
                                     QuestionKind::sweep};
  int doubted = 0;
  int changed = 0;
  for (int round = 0; round < 300; ++round) {
    const Vec3 from(normal(random), normal(random), normal(random));
    const Vec3 to(normal(random), normal(random), normal(random));
    LostBall lost(from, to);
    static_cast<void>(lost.world.define(ball("wall", {0, 0, 20}, 3)));
    const std::int64_t age_ns = static_cast<std::int64_t>(random() % 10) * kStaleSecond;
    lost.step(11 * kStaleSecond + age_ns);
    const double reach_m = (to - from).norm() * 1e-9 * static_cast<double>(age_ns);
    LostBall there(from, to);
    const ObjectId elsewhere = there.id;
    there.world.set_stale(elsewhere, false);
    static_cast<void>(there.world.define(ball("wall", {0, 0, 20}, 3)));
    for (const QuestionKind kind : kKinds) {
      const std::vector<double> numbers = any_question_about(kind, random);
      const Answers given = lost.ask(kind, numbers, HitMode::closest, &mover);
      doubted += given.reasons[0] == UndecidedReason::stale_object ? 1 : 0;
      for (int place = 0; place < 20; ++place) {
        const Vec3 out = Vec3(normal(random), normal(random), normal(random)).normalized() * reach_m;
        there.world.move(elsewhere,
                         {.position = to + out * std::cbrt(std::uniform_real_distribution<double>()(random))},
                         12 * kStaleSecond, true);
        there.step(12 * kStaleSecond);
        const Answers truth = there.ask(kind, numbers, HitMode::closest, &mover);
        const bool names_it = !given.hits.empty() && given.hits[0].object == lost.id;
        const bool differs =
            truth.answers[0] != given.answers[0] ||
            (!truth.hits.empty() && kind != QuestionKind::sphere && kind != QuestionKind::box &&
             truth.hits[0].distance_m + truth.hits[0].error_m < given.hits[0].distance_m - given.hits[0].error_m);
        if (given.answers[0] == Verdict::undecided || names_it || !differs) continue;
        ++changed;
      }
    }
  }
  EXPECT_EQ(changed, 0);
  EXPECT_GT(doubted, 100);
}

}  // namespace
}  // namespace collided::engine
