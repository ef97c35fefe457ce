#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class FleetVerb : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }

  static FleetMember member(const std::string& name, FleetRole role = FleetRole::primary) {
    return {.server = 1,
            .epoch = 1'795'000'000,
            .role = role,
            .state = "ready",
            .name = name,
            .host = "hall",
            .pid = 4711,
            .version_text = "0.2.0",
            .started = 1'795'000'000s,
            .up = 3h,
            .version = 18'204,
            .lag = 12ms,
            .scene_fingerprint = 0xabc,
            .world_hash = 0x123,
            .hash_time = 1'795'000'100s,
            .alarm = ""};
  }
  /// What is said of two members of which the second one is changed.
  template <class Change>
  static Ran with_second(const Change& change) {
    fake::server().members = {member("a"), member("b", FleetRole::standby)};
    change(fake::server().members[1]);
    return collide("fleet");
  }
};

TEST_F(FleetVerb, ListsWhoIsWho) {
  fake::server().members = {member("a"), member("b", FleetRole::standby)};
  const Ran ran = at_terminal("fleet");
  EXPECT_EQ(ran.code, 0);
  EXPECT_EQ(ran.out,
            "NAME  ROLE     STATE  EPOCH       WORLD   LAG    VERSION  HOST  PID   UP\n"
            "a     primary  ready  1795000000  18 204  12 ms  0.2.0    hall  4711  3 h 0 m\n"
            "b     standby  ready  1795000000  18 204  12 ms  0.2.0    hall  4711  3 h 0 m\n");
  EXPECT_EQ(collide("fleet --json --fields name,role,world_hash").out,
            "{\"name\":\"a\",\"role\":\"primary\",\"world_hash\":\"0000000000000123\"}\n"
            "{\"name\":\"b\",\"role\":\"standby\",\"world_hash\":\"0000000000000123\"}\n");
}

// Anybody in the network may give a server a name, and this one would set the window's title.
TEST_F(FleetVerb, NoTextOfAnotherServerCommandsATerminal) {
  fake::server().members = {member("a"), member("x\x1b]0;evil\x07")};
  fake::server().members[1].host =
      "y\x1b[2J\xC2\x9B"
      "2J";
  const auto commands = [](const std::string& text) { return text.find_first_of("\x1b\x07") != std::string::npos; };
  for (const char* line : {"fleet", "fleet --json", "fleet --fields name,host"}) {
    const Ran ran = collide(line);
    EXPECT_FALSE(commands(ran.out)) << line << ": " << ran.out;
    EXPECT_FALSE(commands(ran.err)) << line << ": " << ran.err;
    EXPECT_NE(ran.err.find("]0;evil"), std::string::npos) << line << ": " << ran.err;
  }
  const Ran seen = at_terminal("fleet");
  EXPECT_FALSE(commands(seen.out)) << seen.out;
}

TEST_F(FleetVerb, TwoPrimariesAreAFailureWithBothNames) {
  fake::server().members = {member("a"), member("b")};
  const Ran ran = at_terminal("fleet");
  EXPECT_EQ(ran.code, 1);
  EXPECT_TRUE(
      ran.out.ends_with("fail  2 primaries: 'a' (pid 4711 on hall), 'b' (pid 4711 on hall); answers may differ, "
                        "and events come twice\n"
                        "        stop all but one, or give each a --namespace of its own\n"))
      << ran.out;
  const Ran piped = collide("fleet --json");
  EXPECT_EQ(piped.code, 1);
  EXPECT_TRUE(piped.err.starts_with("warning: 2 primaries: ")) << piped.err;
}

TEST_F(FleetVerb, NoPrimaryIsAFailure) {
  fake::server().members = {member("b", FleetRole::standby)};
  const Ran ran = collide("fleet");
  EXPECT_EQ(ran.code, 1);
  EXPECT_EQ(ran.err, "warning: no primary: nobody answers\n");
}

TEST_F(FleetVerb, DifferentVersionsAndClocksAreWarnings) {
  const Ran versions = with_second([](FleetMember& b) { b.version_text = "0.3.0"; });
  EXPECT_EQ(versions.code, 0);
  EXPECT_EQ(versions.err, "warning: different versions: 'a' is 0.2.0; 'b' is 0.3.0\n");
  const auto clock_of = [&](const char* machine, std::chrono::nanoseconds ahead) {
    return with_second([&](FleetMember& b) { b.host = machine, b.clock_ahead = ahead; });
  };
  EXPECT_EQ(clock_of("yard", 1'200ms).code, 0);
  EXPECT_EQ(clock_of("yard", 1'200ms).err,
            "warning: clocks apart: that of 'b' (pid 4711 on yard) is 1.2 s ahead of that of 'a' (pid 4711 on hall)\n");
  EXPECT_EQ(clock_of("yard", -19ms).err, "");
  EXPECT_EQ(clock_of("hall", -1'200ms).err, "") << "one machine has one clock";
}

TEST_F(FleetVerb, DifferentScenesAndWorldsAreFailures) {
  const Ran scenes = with_second([](FleetMember& b) { b.scene_fingerprint = 0xabd; });
  EXPECT_EQ(scenes.code, 1);
  EXPECT_TRUE(scenes.err.starts_with("warning: different scenes: 'a'")) << scenes.err;
  EXPECT_EQ(with_second([](FleetMember& b) { b.scene_fingerprint = 0; }).code, 0)
      << "it has said nothing of its scenes yet";
  const Ran worlds = with_second([](FleetMember& b) { b.world_hash = 0x124; });
  EXPECT_EQ(worlds.code, 1);
  EXPECT_TRUE(worlds.err.starts_with("warning: different worlds: 'a'")) << worlds.err;
  const auto at_another_instant = [](FleetMember& b) { b.world_hash = 0x124, b.hash_time += 1s; };
  EXPECT_EQ(with_second(at_another_instant).code, 0) << "worlds of two instants differ";
}

TEST_F(FleetVerb, WhatAMemberSaysIsWrongWithItIsAFailure) {
  const Ran ran = with_second([](FleetMember& b) { b.alarm = "the disk is full\nball differs"; });
  EXPECT_EQ(ran.code, 1);
  EXPECT_EQ(ran.err,
            "warning: 'b' (pid 4711 on hall): the disk is full\nwarning: 'b' (pid 4711 on hall): ball differs\n");
}

TEST_F(FleetVerb, HandoverSaysWhoHasThePlaceOnceItHas) {
  fake::server().members = {member("a"), member("b", FleetRole::standby)};
  nlohmann::json sent;
  fake::server().command = [&](const std::string& name, const nlohmann::json& arguments, const Shape&) {
    sent = {{"name", name}, {"to", arguments.value("to", "?")}};
    fake::server().members = {member("b")};
    fake::server().members[0].epoch = 1'795'000'007;
    return Result<std::string>(R"({"to":"b"})");
  };
  EXPECT_EQ(at_terminal("handover").out, "b has the place of a\n");
  EXPECT_EQ(sent, (nlohmann::json{{"name", "handover"}, {"to", ""}}));
  fake::server().members = {member("a"), member("b", FleetRole::standby)};
  EXPECT_EQ(collide("handover b --json").out, "{\"to\":\"b\",\"epoch\":1795000007}\n");
  EXPECT_EQ(sent["to"], "b");
}

// The new server may be quicker than the old one's answer, which counts no more then.
TEST_F(FleetVerb, HandoverIsDoneThoughItsAnswerIsLost) {
  fake::server().members = {member("a"), member("b", FleetRole::standby)};
  fake::server().command = [&](const std::string&, const nlohmann::json&, const Shape&) -> Result<std::string> {
    fake::server().members = {member("b")};
    fake::server().members[0].server = 2;
    return Error{ErrorCode::disconnected, "handover: the server was replaced by another one meanwhile", ""};
  };
  EXPECT_EQ(at_terminal("handover").out, "b has the place of a\n");
}

TEST_F(FleetVerb, HandoverThatNobodyTakesIsNoneAndARefusalIsSaid) {
  fake::server().members = {member("a"), member("b", FleetRole::standby)};
  fake::server().command = [](const std::string&, const nlohmann::json&, const Shape&) {
    return Result<std::string>(R"({"to":"b"})");
  };
  const Ran ran = collide("handover");
  EXPECT_EQ(ran.code, 1);
  EXPECT_TRUE(ran.err.starts_with("error: 'b' has not taken the place\n")) << ran.err;
  fake::server().command = [](const std::string&, const nlohmann::json&, const Shape&) -> Result<std::string> {
    return Error{ErrorCode::refused, "no server stands by that is ready. Nothing was done",
                 "collide fleet shows who is there, and what is wrong"};
  };
  EXPECT_EQ(collide("handover").code, 5);
}

TEST_F(FleetVerb, OfAShardMapListsTheShardsAndIsNoWhereOneIsNotThere) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  fake::server().shards = {
      {.name = "west",
       .name_space = "collided/shard_west",
       .low = {-kFar, -kFar, -kFar},
       .high = {0, kFar, kFar},
       .is_there = true,
       .state = "ready",
       .objects = 1'204,
       .static_triangles = 48'000},
      {.name = "east", .low = {0, -kFar, -kFar}, .high = {kFar, kFar, kFar}, .fault = "no server"}};
  const Ran ran = at_terminal("fleet --shards map.json");
  EXPECT_EQ(ran.code, 1);
  EXPECT_EQ(fake::server().shard_map, "map.json");
  EXPECT_NE(ran.out.find("west"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("-inf -inf -inf .. 0 inf inf"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("no server"), std::string::npos) << ran.out;
  EXPECT_EQ(collide("fleet --shards map.json").out, "west\tready\t1204\t48000\t\neast\tnot there\t0\t0\tno server\n");
  fake::server().shards.pop_back();
  EXPECT_EQ(collide("fleet --shards map.json").code, 0);
}

TEST_F(FleetVerb, SplitsAShardAndSaysHowItGoes) {
  fake::server().split = [](const std::string& map, const std::string& next, const ShardSplitOptions& how) {
    EXPECT_EQ(map, "map.json");
    EXPECT_EQ(next, "next.json");
    EXPECT_EQ(how.patience, 5s);
    if (!how.undo) how.said("the next map holds");
    return Result<ShardSplitReport>(
        {.shard = "east", .into = {"near", "far"}, .objects = 1'204, .watches = 1, .took = 9'200ms});
  };
  const Ran ran = at_terminal("fleet split --shards map.json --to next.json --for 5s");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out,
            "east is split into near, far; its server may be stopped\n1 204 objects, 1 watching client, in 9.2 s\n");
  EXPECT_EQ(ran.err, "the next map holds\n");
  EXPECT_EQ(collide("fleet split --shards map.json --to next.json --for 5s -q").out,
            "east\t[\"near\",\"far\"]\t1204\t1\n");
  EXPECT_EQ(at_terminal("fleet split --shards map.json --to next.json --for 5s --undo").out, "east is not split\n");
  fake::server().split = [](const std::string&, const std::string&, const ShardSplitOptions&) {
    return Result<ShardSplitReport>(Error{ErrorCode::bad_input, "the maps differ in their margins", ""});
  };
  EXPECT_EQ(collide("fleet split --shards map.json --to next.json").code, 2);
  EXPECT_EQ(collide("fleet split --to next.json").code, 2);
  EXPECT_EQ(collide("fleet --to next.json").code, 2);
}

TEST_F(FleetVerb, QuestionsGoToAllShardsAndOtherVerbsSayThatTheyCannot) {
  fake::server().ray = [](const RayQuestion&, const AskOptions&) {
    return fake::hit_answer({fake::hit("wall", 2, {2, 0, 0})});
  };
  const Ran asked = collide("ray 0 0 0  1 0 0 --shards map.json -v");
  EXPECT_EQ(asked.code, 0) << asked.err;
  EXPECT_EQ(fake::server().shard_map, "map.json");
  EXPECT_NE(asked.out.find("wall"), std::string::npos);
  EXPECT_NE(asked.err.find("; all shards"), std::string::npos) << asked.err;
  for (const std::string verb : {"status", "ls", "get a", "handover"}) {
    const Ran refused = collide(verb + " --shards map.json");
    EXPECT_EQ(refused.code, 2) << verb;
    EXPECT_NE(refused.err.find("it asks one server, so --shards is not for it"), std::string::npos) << refused.err;
  }
}

TEST_F(FleetVerb, NobodyIsNoServer) { EXPECT_EQ(collide("fleet").code, 4); }

}  // namespace
}  // namespace collided
