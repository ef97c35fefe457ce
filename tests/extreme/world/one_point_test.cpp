// Everything in one point: all pairs touch, every question meets all objects, and each list must stay within what was
// asked for.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>

#include "tests/extreme/worlds.hpp"

namespace collided::engine::one_point_test {
namespace {

TEST(ExtremeOnePoint, EveryPairBeginsOnceAndEndsOnce) {
  extreme::Stage stage;
  std::vector<ObjectId> balls;
  for (int i = 0; i < 600; ++i) balls.push_back(stage.ball("ball" + std::to_string(i), {1, 2, 3}, 0.5));
  EXPECT_EQ(stage.step().size(), 600u * 599 / 2);
  stage.move(balls[0], extreme::at({9, 9, 9}));
  EXPECT_EQ(stage.step().size(), 599u);
  stage.world.remove(balls[1], EndReason::removed);
  EXPECT_EQ(stage.step().size(), 598u);
  EXPECT_EQ(stage.world.contacts().size(), 598u * 597 / 2);
}

/// Resting balls in one place.
void fill_one_place(extreme::Stage& stage) {
  for (int i = 0; i < 99'999; ++i) {
    stage.add("ball" + std::to_string(i), extreme::ball_shape(0.5), extreme::at({1, 2, 3}), false);
  }
}

double seconds_of(const std::function<void()>& work) {
  const auto started = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

// Five billion pairs of which a step needs none or 99,999: looking at each would take minutes.
TEST(ExtremeOnePoint, RestingObjectsArePairedWithMoversOnly) {
  extreme::Stage stage;
  fill_one_place(stage);
  EXPECT_LT(seconds_of([&] { EXPECT_TRUE(stage.step().empty()) << "nothing moves, so nothing is paired"; }), 5);
  const ObjectId mover = stage.ball("mover", {1, 2, 9}, 0.5);
  EXPECT_LT(seconds_of([&] { EXPECT_TRUE(stage.step().empty()); }), 5);
  stage.move(mover, extreme::at({1, 2, 4}));
  EXPECT_LT(seconds_of([&] { EXPECT_EQ(stage.step({.contacts = false}).size(), 99'999u) << "kissing all of them"; }),
            20);
}

TEST(ExtremeOnePoint, AHundredThousandAnswerWithinTheLimitsAsked) {
  extreme::Stage stage;
  fill_one_place(stage);
  stage.step();
  const auto started = std::chrono::steady_clock::now();
  const Answers closest = stage.ray({1, 2, 0}, {0, 0, 1});
  ASSERT_TRUE(extreme::is_hit(closest));
  EXPECT_EQ(closest.hits[0].distance_m, 2.5);
  EXPECT_EQ(stage.world.info(closest.hits[0].object)->name, "ball0") << "ties go to the lowest";
  Questions questions;
  questions.kind = QuestionKind::sphere;
  questions.max_hits = 10;
  const std::vector<double> ball{1, 2, 3, 0.25};
  questions.numbers = ball;
  Answers overlap;
  QueryScratch scratch;
  answer(*stage.world.newest(), questions, overlap, scratch);
  EXPECT_EQ(overlap.answers.at(0), Verdict::undecided);
  EXPECT_EQ(overlap.reasons.at(0), UndecidedReason::truncated);
  ASSERT_EQ(overlap.hits.size(), 10u);
  const std::vector<std::string> first_by_name{"ball0",     "ball1",     "ball10",    "ball100",   "ball1000",
                                               "ball10000", "ball10001", "ball10002", "ball10003", "ball10004"};
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(stage.world.info(overlap.hits[i].object)->name, first_by_name[i]);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  EXPECT_LT(seconds, 5) << "200,000 exact tests";
}

}  // namespace
}  // namespace collided::engine::one_point_test
