// What the numbers of an answer mean at their edges: ties, inside, lengths that underflow.
#include <gtest/gtest.h>

#include "server/world/query/pair_report.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

using extreme::at;
using extreme::Stage;

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

Answers ask(const Stage& stage, QuestionKind kind, const std::vector<double>& numbers,
            HitMode mode = HitMode::closest) {
  Answers answers;
  QueryScratch scratch;
  answer(*stage.world.newest(), {.kind = kind, .mode = mode, .max_hits = 100, .numbers = numbers}, answers, scratch);
  return answers;
}

std::vector<std::string> names(const Stage& stage, const Answers& answers) {
  std::vector<std::string> names;
  for (const AnswerHit& hit : answers.hits) names.push_back(stage.world.info(hit.object)->name);
  return names;
}

// Six balls about a point, each as far from it, in whichever order they come into the world.
TEST(NumberMeaning, WhatIsEquallyFarStandsByName) {
  std::mt19937_64 random = oracle::seeded(2001);
  const std::vector<Vec3> around{{2, 0, 0}, {-2, 0, 0}, {0, 2, 0}, {0, -2, 0}, {0, 0, 2}, {0, 0, -2}};
  const std::vector<std::string> in_order{"a", "b", "c", "d", "e", "f"};
  std::vector<std::size_t> order{0, 1, 2, 3, 4, 5};
  for (int round = 0; round < 20; ++round) {
    std::shuffle(order.begin(), order.end(), random);
    Stage stage;
    for (const std::size_t i : order) stage.ball(in_order[i], around[i], 0.5);
    stage.step();
    EXPECT_EQ(names(stage, ask(stage, QuestionKind::near, {0, 0, 0, kUnbounded})), in_order);
    EXPECT_EQ(names(stage, ask(stage, QuestionKind::sphere, {0, 0, 0, 1.75})), in_order);
  }
}

// Two boxes with one face in common: a ray onto it meets both at one distance.
TEST(NumberMeaning, OfTwoHitsAtOneDistanceTheFirstByNameIsTheClosest) {
  for (const bool is_first : {true, false}) {
    Stage stage;
    for (const std::string name : {is_first ? "left" : "right", is_first ? "right" : "left"})
      stage.block(name, {0, 0, 0}, {1, 1, 1});
    stage.step();
    const std::vector<double> down{0.25, 0.5, 3, 0, 0, -1, 10};
    EXPECT_EQ(names(stage, ask(stage, QuestionKind::ray, down)), std::vector<std::string>{"left"});
    EXPECT_EQ(names(stage, ask(stage, QuestionKind::ray, down, HitMode::all)),
              (std::vector<std::string>{"left", "right"}));
  }
}

TEST(NumberMeaning, NearSaysWhetherThePointIsInASolid) {
  Stage stage;
  stage.block("box", {0, 0, 0}, {1, 1, 1});
  stage.load("sheet", scenes::icosphere(1, 8));
  stage.step();
  const auto inside = [&](const Vec3& point, double reach_m) {
    const Answers answers = ask(stage, QuestionKind::near, {point.x(), point.y(), point.z(), reach_m});
    EXPECT_EQ(answers.hits.size(), 1u);
    return !answers.hits.empty() && (answers.hits[0].flags & kHitInside) != 0;
  };
  EXPECT_TRUE(inside({0.5, 0, 0}, 1));
  EXPECT_TRUE(inside({1, 0.5, 0}, 1)) << "on its face";
  EXPECT_FALSE(inside({std::nextafter(1, 2), 0.5, 0}, 1));
  const Vec3 vertex = scenes::icosphere(1, 8).vertices[0];
  EXPECT_FALSE(inside(vertex, 0.5)) << "on a surface, which holds nothing";
}

// Centres and radii of a few of the smallest doubles: the truth is a whole number of them.
TEST(NumberMeaning, BoundsHoldWhereLengthsUnderflow) {
  std::mt19937_64 random = oracle::seeded(2002);
  const double unit = std::numeric_limits<double>::denorm_min();
  int apart = 0;
  for (int round = 0; round < 2'000; ++round) {
    const auto some = [&](int most) { return static_cast<int>(random() % static_cast<unsigned>(most + 1)); };
    const int radius_a = some(5), radius_b = some(5), gap = 1 + some(40);
    Stage stage;
    const ObjectId a = stage.ball("a", {0, 0, 0}, radius_a * unit);
    const ObjectId b = stage.ball("b", {(radius_a + gap + radius_b) * unit, 0, 0}, radius_b * unit);
    stage.step();
    const PairReport pair = report_pair(*stage.world.newest(), a, b, {});
    ASSERT_EQ(pair.touches, Decision::no);
    ++apart;
    EXPECT_LE(std::abs(static_cast<long double>(pair.separation.distance_m) - static_cast<long double>(gap) * unit),
              pair.separation.error_m);
    const Answers answers = ask(stage, QuestionKind::near, {-gap * unit, 0, 0, kUnbounded});
    ASSERT_EQ(answers.hits.size(), 2u);
    const long double to_a = static_cast<long double>(gap - radius_a) * unit;
    if (to_a > 0) {
      EXPECT_LE(std::abs(static_cast<long double>(answers.hits[0].distance_m) - to_a), answers.hits[0].error_m);
    }
  }
  EXPECT_EQ(apart, 2'000);
}

}  // namespace
}  // namespace collided::engine
