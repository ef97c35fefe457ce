// A shard is split while its world runs: what is given up, and what is gone on with.
#include <chrono>
#include <csignal>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "idl/commands.hpp"
#include "idl/shards/shard_split.hpp"
#include "tests/service/eventually.hpp"
#include "tests/shards/sharded_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

constexpr const char* kBefore = R"({"margin_m": 1, "shards": [
  {"name": "west", "low": [null, null, null], "high": [0, null, null]},
  {"name": "east", "low": [0, null, null], "high": [null, null, null]}]})";
constexpr const char* kAfter = R"({"margin_m": 1, "shards": [
  {"name": "west", "low": [null, null, null], "high": [0, null, null]},
  {"name": "near", "low": [0, null, null], "high": [10, null, null]},
  {"name": "far", "low": [10, null, null], "high": [null, null, null]}]})";

class SplitWorld : public testing_support::ShardedWorldTest {
 protected:
  void SetUp() override {
    halves_ = write_map(kBefore, "halves.json");
    thirds_ = write_map(kAfter, "thirds.json");
    map_file_ = halves_;
    for (const char* shard : {"west", "east"}) start_shard(shard);
    client_ = std::make_unique<ShardedClient>(connect_sharded());
  }
  void start_new() {
    map_file_ = thirds_;
    for (const char* shard : {"near", "far"}) start_shard(shard);
    map_file_ = halves_;
  }
  Result<ShardSplitReport> split(ShardSplitOptions how = {}) {
    return split_shard(halves_, thirds_, {.domain = domain_, .wait = 2s}, how);
  }
  std::vector<std::string> names() {
    std::vector<std::string> names;
    for (const ShardState& shard : client_->shards()) names.push_back(shard.name);
    return names;
  }
  /// What a ray along the x axis meets first, at this height.
  std::string first_hit(double z) {
    const Result<Answer> answer = client_->ask(RayQuestion{.origin = {-50, 0, z}, .direction = {1, 0, 0}});
    if (!answer) return answer.error().message;
    return answer->hits.empty() ? "verdict " + std::to_string(static_cast<int>(answer->verdict))
                                : answer->hits[0].object;
  }
  json said_by(const std::string& shard) {
    Client client = connect_to_shard(shard);
    const Result<std::string> said = client.command("shard", "{}");
    return json::parse(said ? *said : "{}");
  }

  std::string halves_;
  std::string thirds_;
  std::unique_ptr<ShardedClient> client_;
};

TEST_F(SplitWorld, WithoutTheNewShardsNothingIsChanged) {
  const Result<ShardSplitReport> report = split();
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::no_server);
  EXPECT_NE(report.error().message.find("shard 'near' is not there"), std::string::npos) << report.error().message;
  EXPECT_FALSE(said_by("east").contains("succession"));
}

// An object that a command gave one shard is nobody's to give to others.
TEST_F(SplitWorld, WhatTheNewShardsLackIsSaidAndTheSplitTakenBack) {
  start_new();
  Client east = connect_to_shard("east");
  ASSERT_TRUE(east.add(
      {.name = "crate", .shape = {SphereShape{.radius_m = 0.5}}, .pose = {.position = {20, 0, 5}}, .moving = false}));
  const Result<ShardSplitReport> report = split({.patience = 3s});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::timeout);
  EXPECT_NE(report.error().message.find("1 object is missing in 'far', 'crate' among them. It was taken back"),
            std::string::npos)
      << report.error().message;
  EXPECT_TRUE(test::eventually([&] { return names() == std::vector<std::string>{"west", "east"}; }));
  EXPECT_EQ(first_hit(5), "crate");
  // Once it is there, the same split is carried out.
  ASSERT_TRUE(connect_to_shard("far").add(
      {.name = "crate", .shape = {SphereShape{.radius_m = 0.5}}, .pose = {.position = {20, 0, 5}}, .moving = false}));
  const Result<ShardSplitReport> again = split();
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->into, (std::vector<std::string>{"near", "far"}));
  EXPECT_EQ(first_hit(5), "crate");
  EXPECT_TRUE(test::eventually([&] { return names() == std::vector<std::string>{"west", "near", "far"}; }));
  // What was split covers nothing, so nobody takes for free what is not there any more; also after a crash.
  const SphereQuestion in_the_air{.center = {20, 0, 9}, .radius_m = 1};
  EXPECT_EQ(east.ask(in_the_air)->reason, UndecidedReason::not_covered);
  servers_[1]->signal(SIGKILL);
  servers_[1]->wait(5s);
  start_shard("east");
  EXPECT_TRUE(test::eventually([&] { return said_by("east")["succession"]["phase"] == "done"; }));
  EXPECT_TRUE(test::eventually([&] {
    const Result<Answer> answer = connect_to_shard("east").ask(in_the_air);
    return answer && answer->reason == UndecidedReason::not_covered;
  }));
}

TEST_F(SplitWorld, OneThatWasCutShortIsGoneOnWithOrTakenBack) {
  start_new();
  const shards::MapSuccession begun{.revision = 5,
                                    .phase = shards::SuccessionPhase::joining,
                                    .from = shards::ShardMap::parse(kBefore).fingerprint(),
                                    .next = shards::ShardMap::parse(kAfter)};
  // The coordinator died when it had told one of them.
  ASSERT_TRUE(connect_to_shard("west").command("succession", shards::succession_text(begun)));
  EXPECT_TRUE(test::eventually([&] { return names().size() == 4; })) << "whichever shard is asked says it";
  ASSERT_TRUE(split({.undo = true}));
  EXPECT_TRUE(test::eventually([&] { return names().size() == 2; }));
  // Then one dies when the next map holds in a part of them.
  ASSERT_TRUE(split({.patience = 30s}));
  EXPECT_EQ(said_by("west")["succession"]["phase"], "done");
  const Result<ShardSplitReport> again = split();
  EXPECT_TRUE(again) << "what is done may be done again";
  EXPECT_FALSE(split({.undo = true}));
}

TEST_F(SplitWorld, PublishersThatRestAndWatchesTakePart) {
  Result<ShardedPublisher> publisher = client_->publish("rests", {.lease = 60s});
  ASSERT_TRUE(publisher);
  const auto ball = [](const std::string& name, double x) {
    return ObjectOptions{.name = name, .shape = {SphereShape{.radius_m = 0.5}}, .pose = {.position = {x, 0, 5}}};
  };
  ASSERT_TRUE(publisher->add(ball("one", 20)));
  ASSERT_TRUE(publisher->add(ball("other", 20.5)));
  ASSERT_TRUE(publisher->flush());
  Result<ShardedWatch> watch = client_->watch();
  ASSERT_TRUE(watch);
  EXPECT_TRUE(test::eventually([&] {
    watch->next(10ms);
    return watch->open_contacts() == 1;
  }));
  start_new();
  const Result<ShardSplitReport> report = split();
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_GE(report->objects, 2u);
  EXPECT_EQ(report->watches, 1u);
  servers_[1]->signal(SIGTERM);
  servers_[1]->wait(10s);
  EXPECT_FALSE(watch->next(500ms)) << "what goes on is not told";
  EXPECT_EQ(watch->open_contacts(), 1u);
  EXPECT_EQ(first_hit(5), "one");
  // Who starts with the map before learns the one that holds.
  ShardedClient late = connect_sharded();
  EXPECT_EQ(late.shards().size(), 3u);
  const Result<Answer> answer = late.ask(RayQuestion{.origin = {-50, 0, 5}, .direction = {1, 0, 0}});
  ASSERT_TRUE(answer);
  ASSERT_FALSE(answer->hits.empty());
  EXPECT_EQ(answer->hits[0].object, "one");
}

TEST_F(SplitWorld, AServerTakesNoOtherMapAndNoStepBack) {
  const shards::ShardMap halves = shards::ShardMap::parse(kBefore);
  const shards::ShardMap thirds = shards::ShardMap::parse(kAfter);
  Client west = connect_to_shard("west");
  const auto tell = [&](std::uint64_t revision, shards::SuccessionPhase phase, std::uint64_t from) {
    const Result<std::string> told = west.command(
        "succession", shards::succession_text({.revision = revision, .phase = phase, .from = from, .next = thirds}));
    return told ? std::string("taken") : told.error().message;
  };
  using enum shards::SuccessionPhase;
  EXPECT_NE(tell(1, joining, 4711).find("it begins with map"), std::string::npos);
  EXPECT_EQ(tell(2, joining, halves.fingerprint()), "taken");
  EXPECT_NE(tell(2, in_force, halves.fingerprint()).find("revision 2 is not higher than 2"), std::string::npos);
  EXPECT_EQ(tell(3, in_force, halves.fingerprint()), "taken");
  EXPECT_NE(tell(4, withdrawn, halves.fingerprint()).find("'withdrawn' does not come after 'in_force'"),
            std::string::npos);
  EXPECT_NE(west.command("succession", R"({"phase": "joining"})").error().message.find("Nothing was done"),
            std::string::npos);
}

}  // namespace
}  // namespace collided
