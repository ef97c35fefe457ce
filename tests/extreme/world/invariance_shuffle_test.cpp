// Which object was defined first decides slots, cells' order and the tree: nothing of that may reach an answer, save
// the tie that the lower id wins.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/extreme/mixed.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine::invariance_shuffle_test {
namespace {

/// Answers with names for ids, hits of a question in the order of (distance, name).
std::vector<std::string> named(const extreme::Stage& stage, const Answers& answers) {
  std::vector<std::string> lines;
  std::size_t next = 0;
  for (std::size_t i = 0; i < answers.answers.size(); ++i) {
    std::vector<std::tuple<double, std::string, double>> hits;
    for (std::uint32_t h = 0; h < answers.hit_counts[i]; ++h, ++next) {
      const AnswerHit& hit = answers.hits[next];
      hits.emplace_back(hit.distance_m, stage.world.info(hit.object)->name, hit.error_m);
    }
    std::sort(hits.begin(), hits.end());
    std::string line = std::to_string(static_cast<int>(answers.answers[i]));
    for (const auto& [distance, name, error] : hits) {
      line += " " + name + " " + std::to_string(std::bit_cast<std::uint64_t>(distance)) + " " +
              std::to_string(std::bit_cast<std::uint64_t>(error));
    }
    lines.push_back(line);
  }
  return lines;
}

TEST(ExtremeInvarianceShuffle, TheOrderOfDefinitionDoesNotShow) {
  std::mt19937_64 random = oracle::seeded(431);
  for (const extreme::Ground ground : extreme::kGrounds) {
    extreme::Mixer mixer(random, ground);
    extreme::Cast cast = mixer.cast(80);
    std::vector<std::vector<double>> questions;
    for (const auto kind : extreme::kKinds) questions.push_back(mixer.questions(kind, 150));
    extreme::Stage first;
    extreme::build(first, cast);
    EXPECT_GT(first.world.contacts().size(), 20u) << "the scene must be worth testing";
    for (int shuffle = 0; shuffle < 4; ++shuffle) {
      std::shuffle(cast.movers.begin(), cast.movers.end(), random);
      extreme::Stage other;
      extreme::build(other, cast);
      ASSERT_EQ(extreme::named_contacts(other.world), extreme::named_contacts(first.world));
      for (std::size_t k = 0; k < questions.size(); ++k) {
        ASSERT_EQ(named(other, other.ask(extreme::kKinds[k], questions[k], HitMode::all)),
                  named(first, first.ask(extreme::kKinds[k], questions[k], HitMode::all)));
      }
    }
  }
}

// The nearest of two equals is the first by name, whichever came first into the world.
TEST(ExtremeInvarianceShuffle, TiesGoByName) {
  for (const bool swapped : {false, true}) {
    extreme::Stage stage;
    const ObjectId one = stage.ball(swapped ? "b" : "a", {0, 0, 0}, 1);
    const ObjectId other = stage.ball(swapped ? "a" : "b", {0, 0, 0}, 1);
    const ObjectId first = swapped ? other : one;
    stage.step();
    EXPECT_EQ(stage.ray({-5, 0, 0}, {1, 0, 0}).hits.at(0).object, first);
    EXPECT_EQ(stage.ask(QuestionKind::sphere, {0, 0, 0, 1}).hits.at(0).object, first);
    EXPECT_EQ(stage.ask(QuestionKind::near, {5, 0, 0, 9}).hits.at(0).object, first);
  }
}

}  // namespace
}  // namespace collided::engine::invariance_shuffle_test
