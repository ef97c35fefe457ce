// A shape that is not in the world, from pose to pose: what it meets first, against the overlap questions at thousands of
// its poses.
#include <gtest/gtest.h>

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "tests/extreme/worlds.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine::sweep_question_test {
namespace {

std::vector<double> numbers_of_way(const Pose& from, const Pose& to) {
  std::vector<double> numbers;
  for (const Pose* pose : {&from, &to}) {
    numbers.insert(numbers.end(), pose->position.begin(), pose->position.end());
    numbers.insert(numbers.end(), {pose->rotation.w(), pose->rotation.x(), pose->rotation.y(), pose->rotation.z()});
  }
  return numbers;
}

Answers sweep_of(const extreme::Stage& stage, const ObjectInfo* mover, const Pose& from, const Pose& to,
                 std::string_view skip = {}) {
  const std::vector<double> numbers = numbers_of_way(from, to);
  Answers answers;
  QueryScratch scratch;
  Questions questions;
  questions.kind = QuestionKind::sweep;
  questions.numbers = numbers;
  questions.skip = skip;
  questions.mover = mover;
  answer(*stage.world.newest(), questions, answers, scratch);
  return answers;
}

std::string name_of(const extreme::Stage& stage, const AnswerHit& hit) { return stage.world.info(hit.object)->name; }

TEST(ExtremeSweepQuestion, TheFirstOfThreeIsToldAndWhoIsLeftOutIsNot) {
  extreme::Stage stage;
  stage.load("wall", scenes::box({0x1p-11, 2, 2}, {4, 0, 0}));
  stage.block("post", {6, 0, 0}, {0.25, 0.25, 2});
  stage.ball("lamp", {8, 0, 0}, 0.5);
  stage.step();
  const ObjectInfo cube = without_world(extreme::box_shape({0.5, 0.5, 0.5}));
  const Pose from = extreme::at({0, 0, 0}), to = extreme::at({16, 0, 0});
  const Answers all = sweep_of(stage, &cube, from, to);
  ASSERT_TRUE(extreme::is_hit(all));
  EXPECT_EQ(name_of(stage, all.hits[0]), "wall");
  const double truth = (4 - 0x1p-11 - 0.5) / 16;
  EXPECT_LE(all.brackets[0].low, truth);
  EXPECT_GE(all.brackets[0].high, truth);
  EXPECT_LE(all.brackets[0].high - all.brackets[0].low, 1e-6);
  EXPECT_NEAR(all.hits[0].normal.x(), 1, 1e-6) << "from the shape to what it meets";
  EXPECT_EQ(name_of(stage, sweep_of(stage, &cube, from, to, "wall").hits.at(0)), "post");
  EXPECT_EQ(name_of(stage, sweep_of(stage, &cube, from, to, "[wp]*").hits.at(0)), "lamp");
  EXPECT_TRUE(extreme::is_miss(sweep_of(stage, &cube, from, extreme::at({0, 16, 0}))));
  const Answers inside = sweep_of(stage, &cube, extreme::at({4, 0, 0}), to);
  ASSERT_TRUE(extreme::is_hit(inside));
  EXPECT_EQ(inside.brackets[0].high, 0);
  EXPECT_EQ(inside.brackets[0].low, 0);
}

TEST(ExtremeSweepQuestion, WhatIsNoQuestionIsInvalid) {
  extreme::Stage stage;
  stage.step();
  const ObjectInfo cube = without_world(extreme::box_shape({1, 1, 1}));
  EXPECT_EQ(sweep_of(stage, nullptr, extreme::at({0, 0, 0}), extreme::at({1, 0, 0})).answers.at(0), Verdict::invalid);
  EXPECT_EQ(sweep_of(stage, &cube, extreme::at({NAN, 0, 0}), extreme::at({1, 0, 0})).answers.at(0), Verdict::invalid);
  const Pose scaled = extreme::at({1, 0, 0}, Quat(2, 0, 0, 0));
  EXPECT_EQ(sweep_of(stage, &cube, extreme::at({0, 0, 0}), scaled).answers.at(0), Verdict::invalid);
  EXPECT_TRUE(extreme::is_miss(sweep_of(stage, &cube, extreme::at({0, 0, 0}), extreme::at({1, 0, 0}))));
}

TEST(ExtremeSweepQuestion, OverlapQuestionsAlongTheWayAgree) {
  constexpr int kSamples = 2'000;
  std::mt19937_64 generator = oracle::seeded(503);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&](double reach) {
    return Vec3(reach * uniform(generator), reach * uniform(generator), reach * uniform(generator));
  };
  const auto turn = [&]() -> Quat {
    return Quat(uniform(generator), uniform(generator), uniform(generator), uniform(generator)).normalized();
  };
  extreme::Stage stage;
  stage.load("rock", scenes::icosphere(3, 1));
  for (int i = 0; i < 12; ++i) {
    stage.ball("ball" + std::to_string(i), point(4), 0.3);
    stage.add("slab" + std::to_string(i), extreme::box_shape({0.5, 0.3, 0x1p-9}), extreme::at(point(4), turn()));
    stage.add("shell" + std::to_string(i), extreme::mesh_shape(scenes::icosphere(1, 0.4)),
              extreme::at(point(4), turn()));
  }
  stage.step();
  const Vec3 half(0.4, 0.1, 0.05);
  const ObjectInfo mover = without_world(extreme::box_shape(half));
  int hits = 0, misses = 0;
  for (int i = 0; i < 60; ++i) {
    const Pose from = extreme::at(point(5), turn()), to = extreme::at(point(5), i % 3 == 0 ? from.rotation : turn());
    const Answers found = sweep_of(stage, &mover, from, to);
    ASSERT_NE(found.answers[0], Verdict::undecided) << i;
    const bool is_hit = extreme::is_hit(found);
    (is_hit ? hits : misses) += 1;
    const BodyMotion motion(frame_of(from), frame_of(to));
    const auto touches = [&](double t) {
      const Frame frame = motion.at(t);
      const Quat q(frame.rotation);
      return extreme::is_hit(stage.ask(QuestionKind::box,
                                       {frame.position.x(), frame.position.y(), frame.position.z(), half.x(), half.y(),
                                        half.z(), q.w(), q.x(), q.y(), q.z()},
                                       HitMode::any));
    };
    if (is_hit) { EXPECT_TRUE(touches(found.brackets[0].high)) << i; }
    // The asked box is turned by a rounded quaternion: at the bracket itself they may differ.
    const double clear = is_hit ? found.brackets[0].low - 1e-9 : 1;
    for (int sample = 0; sample <= clear * kSamples; ++sample) {
      ASSERT_FALSE(touches(static_cast<double>(sample) / kSamples)) << i << " at " << sample;
    }
  }
  std::printf("%d hits, %d misses\n", hits, misses);
  EXPECT_GT(hits, 15);
  EXPECT_GT(misses, 5);
}

}  // namespace
}  // namespace collided::engine::sweep_question_test
