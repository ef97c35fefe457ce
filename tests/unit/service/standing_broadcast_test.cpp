// What travels of standing questions: frames without a gap that, one after the other, lead to the state and its sum.
#include "server/service/events/standing_broadcast.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/oracle/seed.hpp"
#include "tests/unit/world/standing_fixture.hpp"

namespace collided::engine::service {
namespace {

/// Keeps what a subscriber would, by the rules of collided.idl.
class StandingKeeper : public EventWriter {
 public:
  using Pair = std::pair<ObjectId, ObjectId>;  // object, question

  bool contacts_wanted() const override { return false; }
  bool persisted_wanted() const override { return false; }
  bool probes_wanted() const override { return false; }
  void write_events(const EventColumns&, const Stamp&) override {}
  void write_persisted(const EventColumns&, const Stamp&) override {}
  void write_contacts(const ContactColumns&, const Stamp&, std::uint64_t) override {}
  void write_probes(const ProbeColumns&, const Stamp&) override {}
  void write_status(const StatusColumns&) override {}

  void write_standing_events(const StandingColumns& events, const Stamp&) override {
    EXPECT_EQ(events.first_sequence, last_sequence + 1);
    for (std::size_t i = 0; i < events.size(); ++i) {
      ++last_sequence;
      const auto kind = static_cast<StandingEventKind>(events.kinds[i]);
      ++kinds[kind];
      const ObjectId standing = events.standings[i];
      EXPECT_TRUE(std::ranges::binary_search(events.named_ids, standing));
      switch (kind) {
        case StandingEventKind::cross:
          EXPECT_GE(events.bracket_lows[i], events.left_lows[i]);
          EXPECT_FALSE(held.contains({events.objects[i], standing}));
          break;
        case StandingEventKind::changed:
          if (events.others[i] != 0) end({events.others[i], standing}, events.episodes[i]);
          if (events.objects[i] != 0) begin({events.objects[i], standing}, last_sequence);
          break;
        case StandingEventKind::exit:
        case StandingEventKind::leave: end({events.objects[i], standing}, events.episodes[i]); break;
        default: begin({events.objects[i], standing}, events.episodes[i]);
      }
    }
    newest = events;
  }
  void write_standing_state(const StandingStateColumns& state, const Stamp&, std::uint64_t as_of_sequence) override {
    EXPECT_EQ(as_of_sequence, last_sequence);
    if (state.shard == wire_contract::kStandingSum) {
      std::uint64_t hash = 0;
      for (const auto& [pair, episode] : held) hash += wire_contract::contact_hash(pair.first, pair.second, episode);
      EXPECT_EQ(state.count, held.size());
      EXPECT_EQ(state.hash, hash);
      ++sums;
      return;
    }
    std::map<Pair, std::uint64_t>& shard = shards[state.shard];
    shard.clear();
    for (std::size_t i = 0; i < state.size(); ++i)
      shard.emplace(Pair(state.objects[i], state.standings[i]), state.episodes[i]);
  }
  /// What all shards hold.
  std::map<Pair, std::uint64_t> in_shards() const {
    std::map<Pair, std::uint64_t> all;
    for (const auto& [number, shard] : shards) all.insert(shard.begin(), shard.end());
    return all;
  }

  std::uint64_t last_sequence = 0;
  std::map<Pair, std::uint64_t> held;  // with their episodes
  std::map<std::uint8_t, std::map<Pair, std::uint64_t>> shards;
  std::map<StandingEventKind, std::size_t> kinds;
  std::size_t sums = 0;
  StandingColumns newest;

 private:
  void begin(const Pair& pair, std::uint64_t episode) {
    EXPECT_EQ(episode, last_sequence);
    EXPECT_TRUE(held.emplace(pair, episode).second) << "it holds already";
  }
  void end(const Pair& pair, std::uint64_t episode) {
    const auto found = held.find(pair);
    ASSERT_NE(found, held.end()) << "it does not hold";
    EXPECT_EQ(found->second, episode);
    held.erase(found);
  }
};

class StandingBroadcasts : public StandingTest {
 protected:
  FenceDefinition region(const std::string& name, const Vec3& at, std::uint8_t detects = kDetectAll) {
    return {.name = name, .shape = box({1, 1, 1}, at), .detects = detects};
  }
  FenceDefinition bands(const std::string& name) {
    FenceDefinition definition{.name = name, .only = "ball*"};
    definition.margin = MarginBands{.around = "post", .bands_m = {3, 1, 0}};
    return definition;
  }
  FenceDefinition nearest(const std::string& name) {
    FenceDefinition definition{.name = name, .shape = ball(0), .only = "ball*"};
    definition.nearest = NearestRule{.within_m = 5};
    return definition;
  }
  void publish(double time_s) {
    step_at(time_s);
    broadcast_.publish([](ObjectId) { return false; });
    broadcast_.publish_sum(wire_contract::ServerState::ready);
  }

  StandingKeeper keeper_;
  StandingBroadcast broadcast_{world_, keeper_, [](const std::string& notice) { ADD_FAILURE() << notice; }};
};

TEST_F(StandingBroadcasts, ACrossingIsOneRowWithBothBrackets) {
  ASSERT_EQ(refusal(region("gate", {0, 0, 0})), "");
  const ObjectId drone = start("ball", ball(0.1), {-3, 0, 0});
  publish(0);
  pose(drone, {3, 0, 0}, 1);
  publish(1);
  const StandingColumns& crossed = keeper_.newest;
  ASSERT_EQ(crossed.size(), 1U);
  EXPECT_EQ(crossed.kinds[0], static_cast<std::uint8_t>(StandingEventKind::cross));
  EXPECT_EQ(crossed.detects[0], kDetectAll);
  EXPECT_EQ(crossed.reasons[0], static_cast<std::uint8_t>(EndReason::none));
  // It comes in after 1.9 m of 6 and is out after 4.1.
  EXPECT_NEAR(1 - crossed.bracket_lows[0], 1.9 / 6, 1e-5);
  EXPECT_NEAR(1 - crossed.left_highs[0], 4.1 / 6, 1e-5);
  EXPECT_NEAR(crossed.points[0], -1, 1e-5);
  EXPECT_EQ(crossed.objects[0], drone);
  EXPECT_EQ(crossed.others[0], 0U);
  EXPECT_EQ(crossed.forms[0], static_cast<std::uint8_t>(StandingForm::region));
  EXPECT_TRUE(std::isinf(crossed.contact_lows[0]));
}

TEST_F(StandingBroadcasts, ARegionThatDoesNotDetectCrossingsHasTwoRows) {
  ASSERT_EQ(refusal(region("gate", {0, 0, 0}, codes::kDetectEnter)), "");
  const ObjectId drone = start("ball", ball(0.1), {-3, 0, 0});
  publish(0);
  pose(drone, {3, 0, 0}, 1);
  publish(1);
  ASSERT_EQ(keeper_.newest.size(), 2U);
  EXPECT_EQ(keeper_.newest.detects, (std::vector<std::uint8_t>{codes::kDetectEnter, codes::kDetectEnter}));
  EXPECT_EQ(keeper_.newest.kinds[0], static_cast<std::uint8_t>(StandingEventKind::enter));
  EXPECT_EQ(keeper_.newest.kinds[1], static_cast<std::uint8_t>(StandingEventKind::exit));
  EXPECT_EQ(keeper_.newest.reasons[1], static_cast<std::uint8_t>(EndReason::crossed));
}

TEST_F(StandingBroadcasts, ABandHasItsDistanceAndWhatIsToCome) {
  ASSERT_EQ(refusal(bands("gap")), "");
  const ObjectId post = add("post", ball(1), {0, 0, 0}, kStill);
  const ObjectId drone = start("ball", ball(0.5), {9, 0, 0});
  publish(0);
  pose(drone, {4, 0, 0}, 1);
  publish(1);
  const StandingColumns& near = keeper_.newest;
  ASSERT_EQ(near.size(), 1U);
  EXPECT_EQ(near.kinds[0], static_cast<std::uint8_t>(StandingEventKind::approach));
  EXPECT_EQ(near.others[0], post);
  EXPECT_EQ(near.bands[0], 3);
  EXPECT_NEAR(near.distances[0], 3, 1e-5);
  EXPECT_NEAR(near.closings[0], 5, 1e-5);
  EXPECT_NEAR(near.contact_lows[0], 3.0 / 5, 1e-4);
  EXPECT_LE(near.contact_lows[0], near.contact_highs[0]);
  EXPECT_EQ(near.normals[0], -1);
}

TEST_F(StandingBroadcasts, AChangeOfTheNearestIsOneRow) {
  ASSERT_EQ(refusal(nearest("next")), "");
  const ObjectId first = start("ball 1", ball(0.5), {2, 0, 0});
  const ObjectId second = start("ball 2", ball(0.5), {0, 4, 0});
  publish(0);
  ASSERT_EQ(keeper_.newest.size(), 1U);
  EXPECT_EQ(keeper_.newest.objects[0], first);
  EXPECT_EQ(keeper_.newest.others[0], 0U);
  EXPECT_EQ(keeper_.newest.episodes[0], 0U);
  pose(first, {4.5, 0, 0}, 1);
  pose(second, {0, 4, 0}, 1);
  publish(1);
  ASSERT_EQ(keeper_.newest.size(), 1U);
  EXPECT_EQ(keeper_.newest.objects[0], second);
  EXPECT_EQ(keeper_.newest.others[0], first);
  EXPECT_EQ(keeper_.newest.episodes[0], 1U);
  EXPECT_NEAR(keeper_.newest.distances[0], 3.5, 1e-5);
}

// The frames lead to what the shards and the sum say, whatever moves, comes and goes.
TEST_F(StandingBroadcasts, FramesLeadToTheState) {
  std::mt19937_64 random = oracle::seeded(5301);
  const auto within = [&](double most) { return std::uniform_real_distribution<>(-most, most)(random); };
  const auto somewhere = [&] { return Vec3(within(5), within(5), within(1)); };
  add("post", ball(1), {0, 0, 0}, kStill);
  std::vector<ObjectId> balls;
  const auto add_ball = [&](int number) { return start("ball " + std::to_string(number), ball(0.2), somewhere()); };
  for (int i = 0; i < 12; ++i) balls.push_back(add_ball(i));
  broadcast_.mark_all();
  int removed = 0;
  for (int round = 1; round <= 400; ++round) {
    const std::string name = "gate " + std::to_string(round % 7);
    const auto turn = [&](const FenceDefinition& definition) {
      if (!world_.remove_fence(definition.name)) { EXPECT_EQ(refusal(definition), ""); }
    };
    if (round % 5 == 0) turn(region(name, somewhere(), static_cast<std::uint8_t>(1 + round % 7)));
    if (round % 30 == 1) turn(bands("gap"));
    if (round % 40 == 2) turn(nearest("next"));
    for (ObjectId& one : balls) {
      if (random() % 50 == 0) {
        world_.remove(one, EndReason::removed);
        one = add_ball(100 + removed++);
      }
      pose(one, somewhere(), round);
    }
    publish(round);
    ASSERT_EQ(keeper_.in_shards(), keeper_.held) << "round " << round;
    if (HasFailure()) return;
  }
  EXPECT_EQ(keeper_.sums, 400U);
  for (const StandingEventKind kind :
       {StandingEventKind::enter, StandingEventKind::exit, StandingEventKind::cross, StandingEventKind::approach,
        StandingEventKind::near, StandingEventKind::contact, StandingEventKind::leave, StandingEventKind::changed})
    EXPECT_GT(keeper_.kinds[kind], 10U) << name_of(kind);
}

}  // namespace
}  // namespace collided::engine::service
