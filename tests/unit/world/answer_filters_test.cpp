// The filters that a thread keeps, one for each mask and pair of name patterns, beside ones worked out for each question.
#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "server/world/query/query.hpp"
#include "server/world/query/unknown_space.hpp"
#include "tests/oracle/mixed_world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

using oracle::MixedWorld;

ObjectDefinition small_ball(const std::string& name, bool is_unknown) {
  ObjectDefinition definition{.name = name, .scene = "", .shape = {}, .pose = {}, .filter = {}};
  definition.shape.primitives = {Sphere{Vec3::Zero(), 0.1}};
  definition.shape.is_unknown = is_unknown;
  definition.moving = !is_unknown;
  return definition;
}

Questions only(const std::string& pattern) {
  Questions asked;
  asked.only = pattern;
  return asked;
}

/// What the filter should be, without chunks.
void expect_filter(const AnswerFilter& filter, const Snapshot& state, const Questions& asked) {
  Questions without_only = asked;
  without_only.only = {};
  bool is_any_unknown = false;
  for (std::size_t slot = 0; slot < state.objects.size(); ++slot) {
    const ObjectInfo* const info = state.objects[slot].get();
    ASSERT_EQ(filter.allowed.by_slot()[slot], info != nullptr && may_answer(*info, asked) ? 1 : 0) << slot;
    if (info == nullptr || !info->is_unknown) continue;
    ObjectInfo known = *info;
    known.is_unknown = false;
    const bool counts = may_answer(known, without_only);
    is_any_unknown = is_any_unknown || counts;
    ASSERT_EQ(filter.unknown->objects.by_slot()[slot], counts ? 1 : 0) << slot;
  }
  ASSERT_EQ(filter.unknown && filter.unknown->is_any, is_any_unknown);
  ASSERT_EQ(filter.open_scenes.size(), state.scenes.size());
  bool all_open = true;
  for (std::size_t i = 0; i < state.scenes.size(); ++i) {
    bool is_open = true;
    for (const ObjectId part : state.scenes[i]->part_objects)
      is_open = is_open && filter.allowed.by_slot()[slot_of(part)] != 0;
    ASSERT_EQ(filter.open_scenes[i], is_open ? 1 : 0);
    all_open = all_open && is_open;
  }
  ASSERT_EQ(filter.all_open, all_open);
}

// More patterns than are kept, over objects that come and go, scenes that come and go, and states of before.
TEST(AnswerFilters, AreThoseWorkedOutForEachQuestion) {
  std::mt19937_64 random = oracle::seeded(20261132);
  MixedWorld mixed(random);
  std::vector<std::string> patterns{"", "*", "object*", "sheet/1*", "ball*", "nothing"};
  for (int i = 0; i < 10; ++i) patterns.push_back("*" + std::to_string(i));
  AnswerFilters filters;
  std::vector<SnapshotRing::Lease> states{(*mixed).newest()};
  std::vector<ObjectId> balls;
  int next = 0;
  for (std::int64_t step = 2; step < 300; ++step) {
    if (random() % 3 == 0) {
      const ObjectDefinition definition = small_ball("ball" + std::to_string(next++), random() % 8 == 0);
      balls.push_back(std::get<ObjectId>((*mixed).define(definition)));
    }
    if (!balls.empty() && random() % 6 == 0) {
      std::swap(balls[random() % balls.size()], balls.back());
      (*mixed).remove(balls.back(), EndReason::removed);
      balls.pop_back();
    }
    if (step == 200) (*mixed).remove_scene("sheet");
    if (step == 250) {
      // Without a part: no object changes with it.
      ASSERT_TRUE(std::holds_alternative<std::uint32_t>((*mixed).add_scene(World::index_scene({.name = "empty"}, {}))));
    }
    ASSERT_TRUE((*mixed).step(step, 1, {}));
    states.push_back((*mixed).newest());
    if (states.size() > 4) states.erase(states.begin() + static_cast<std::ptrdiff_t>(random() % states.size()));
    for (int i = 0; i < 5; ++i) {
      const Snapshot& state = *states[random() % states.size()];
      Questions asked;
      asked.mask = random() % 4 == 0 ? 1 : 0xffffffff;
      asked.only = patterns[random() % (step < 100 ? 3 : patterns.size())];
      if (random() % 4 == 0) asked.skip = patterns[random() % patterns.size()];
      filters.take(state, asked);
      expect_filter(filters.current(), state, asked);
      if (testing::Test::HasFatalFailure())
        FAIL() << "step " << step << " only " << asked.only << " skip " << asked.skip;
      ASSERT_LE(filters.count(), AnswerFilters::kMost);
    }
  }
  EXPECT_EQ(filters.count(), AnswerFilters::kMost);
  EXPECT_GT(filters.dropped(), 0u) << "there were fewer patterns than are kept";
}

// Patterns used in turn keep their filters: what they hold does not grow, and none gives its place to another.
TEST(AnswerFilters, PatternsInTurnKeepTheirPlaces) {
  std::mt19937_64 random = oracle::seeded(20261133);
  MixedWorld mixed(random);
  AnswerFilters filters;
  const auto state = (*mixed).newest();
  std::vector<std::string> patterns;
  for (std::size_t i = 0; i < AnswerFilters::kMost; ++i) patterns.push_back("*" + std::to_string(i) + "*");
  std::size_t bytes = 0;
  for (int round = 0; round < 3; ++round) {
    for (const std::string& pattern : patterns) filters.take(*state, only(pattern));
    if (round == 0) bytes = filters.bytes();
    EXPECT_EQ(filters.bytes(), bytes);
  }
  EXPECT_EQ(filters.count(), AnswerFilters::kMost);
  EXPECT_EQ(filters.dropped(), 0u);
  // One more takes the place of the one not used for longest.
  const std::string one_more = "one more";
  filters.take(*state, only(one_more));
  EXPECT_EQ(filters.count(), AnswerFilters::kMost);
  EXPECT_EQ(filters.dropped(), 1u);
  for (std::size_t i = 1; i < patterns.size(); ++i) filters.take(*state, only(patterns[i]));
  EXPECT_EQ(filters.dropped(), 1u);
}

}  // namespace
}  // namespace collided::engine
