#include <gtest/gtest.h>

#include <chrono>
#include <string>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

/// `watch` and `publish` with --shards.
class ShardedVerbs : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().events = {{.kind = EventKind::began,
                              .a = "ball/0",
                              .b = "ball/1",
                              .sequence = 1,
                              .episode = 1,
                              .world_time = 12'201ms,
                              .began = 12'201ms,
                              .depth_m = 0.0031},
                             {.kind = EventKind::ended,
                              .reason = EndReason::separated,
                              .a = "ball/0",
                              .b = "ball/1",
                              .sequence = 2,
                              .episode = 1,
                              .world_time = 12'455ms,
                              .began = 12'201ms}};
    fake::server().shards = {{.name = "west", .is_there = true, .state = "ready"},
                             {.name = "east", .is_there = true, .state = "ready"}};
  }
};

TEST_F(ShardedVerbs, AWatchTellsEachContactAsThatOfOneServerDoes) {
  const std::string fields = " -n 2 --fields what,a,b,after,why,sequence";
  const auto events = fake::server().events;
  for (const char* form : {"", " --json", " --csv", " --format '{what} {a} {b}'"}) {
    fake::server().events = events;
    const Ran whole = collide("watch" + fields + form);
    fake::server().events = events;
    const Ran sharded = collide("watch --only 'ball/*' --skip cube --shards map.json" + fields + form);
    EXPECT_EQ(sharded.code, 0) << sharded.err;
    EXPECT_EQ(sharded.out, whole.out);
    EXPECT_NE(whole.out.find("ended"), std::string::npos) << whole.out;
  }
  EXPECT_EQ(fake::server().shard_map, "map.json");
  EXPECT_EQ(fake::server().watched_with.only, "ball/*");
  EXPECT_EQ(fake::server().watched_with.skip, "cube");
}

TEST_F(ShardedVerbs, AWatchSaysWhatItDoesNotHear) {
  fake::server().shards[1] = {.name = "east", .fault = "no server"};
  const Ran away = collide("watch -n 1 --shards map.json");
  EXPECT_EQ(away.code, 0);
  EXPECT_EQ(away.err.find("warning: shard 'east' is not there: no server; what happens in its part is not heard\n"), 0U)
      << away.err;
  fake::server().shard_gaps = 1;
  const Ran gap = collide("watch -n 1 --shards map.json");
  EXPECT_NE(gap.err.find("a shard was silent, or its server was started again; what was missed comes marked resync"),
            std::string::npos)
      << gap.err;
}

TEST_F(ShardedVerbs, APairThatNoShardHoldsIsUndecidedAndFartherApartThanTheMargin) {
  ShardedPairAnswer& pair = fake::server().sharded_pair.emplace();
  pair.verdict = Verdict::undecided;
  pair.reason = UndecidedReason::not_covered;
  pair.farther_than_m = 2;
  const Ran table = collide("pair ball/0 ball/1 --shards map.json --table");
  EXPECT_EQ(table.code, 3);
  EXPECT_EQ(table.out, "undecided: no shard holds both, so they are farther apart than 2 m\n");
  EXPECT_EQ(collide("pair ball/0 ball/1 --shards map.json --fields answer,reason,farther_than").out,
            "undecided\tnot_covered\t2\n");
  EXPECT_EQ(fake::server().shard_map, "map.json");
}

TEST_F(ShardedVerbs, AClearanceSaysUpToWhereItIsComplete) {
  ShardedClearanceAnswer& none = fake::server().sharded_clearance.emplace();
  none.verdict = Verdict::undecided;
  none.reason = UndecidedReason::not_covered;
  none.complete_to_m = 2;
  const Ran ran = collide("clearance ball/0 --to 'ball/*' --shards map.json");
  EXPECT_EQ(ran.code, 3);
  EXPECT_EQ(ran.err, "pairs farther apart than 2 m, the margin of the shards, are not told\n");
  const Ran alone = collide("clearance ball/0 --shards map.json");
  EXPECT_EQ(alone.code, 2);
  EXPECT_NE(alone.err.find("with --shards the other group must be named"), std::string::npos) << alone.err;
}

TEST_F(ShardedVerbs, AMapIsPublishedToAnAddressInEtcdAndNowhereElse) {
  const ScratchFile map("map.json",
                        R"({"shards": [{"name": "all", "low": [null, null, null], "high": [null, null, null]}]})");
  for (const std::string& bad :
       {"fleet publish --shards " + map.path(), "fleet publish --shards " + map.path() + " --to other.json",
        std::string("fleet publish --to etcd://127.0.0.1:1/yard"),
        "fleet publish --shards " + map.path() + " --to etcd://127.0.0.1:1"})
    EXPECT_EQ(collide(bad).code, 2) << bad;
  EXPECT_EQ(collide("fleet --revision 3").err, "error: fleet: --revision is for 'collide fleet publish'\n");
  const Ran away = collide("fleet publish --shards " + map.path() + " --to etcd://127.0.0.1:1/yard --wait 200ms");
  EXPECT_EQ(away.code, 4);
  EXPECT_EQ(away.err, "error: etcd://127.0.0.1:1/yard: etcd does not answer: 127.0.0.1:1: Connection refused\n");
}

TEST_F(ShardedVerbs, AWatchRefusesToAskOneServerOfTheTwo) {
  const Ran ran = collide("watch -n 1 --manifold --shards map.json");
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.err, "error: watch: --manifold asks one server about the two, so --shards is not for it\n");
}

TEST_F(ShardedVerbs, FilesPathsRecordingsAndSpheresArePublishedToShards) {
  const ScratchFile file("poses.csv", "t,name,x,y,z\n5,a,0,0,0\n5,b,1,0,0\n5.01,a,0,0,1\n5.01,b,1,0,1\n");
  for (const std::string& what : {file.path(), std::string("--waypoints '0,0,1 0.1,0,1' --shape sphere:0.1"),
                                  std::string("--spheres 3 --size 0.1 --bounce --steps 2")}) {
    fake::server().publishers.clear();
    const Ran ran = collide("publish " + what + " --shards map.json --as mover --json --fields frames,lost");
    EXPECT_EQ(ran.code, 0) << what << ": " << ran.err;
    ASSERT_EQ(fake::server().publishers.size(), 1U) << what;
    EXPECT_TRUE(fake::server().publishers[0].is_sharded) << what;
    EXPECT_EQ(fake::server().publishers[0].publisher, "mover");
    EXPECT_GE(fake::server().publishers[0].batches.size(), 2U) << what;
  }
  EXPECT_EQ(fake::server().shard_map, "map.json");
  EXPECT_EQ(fake::server().watched_with.only, "spheres/*") << "the spheres hear of their contacts through all shards";
  fake::server().shards[1] = {.name = "east", .fault = "no server"};
  EXPECT_EQ(collide("publish " + file.path() + " --shards map.json")
                .err.find("warning: shard 'east' is not there: no server; it gets its objects when it is there\n"),
            0U);
}

// A frame tells each shard where everything is. What one leaves out would be said to have rested.
TEST_F(ShardedVerbs, AFrameThatLeavesObjectsOutIsRefused) {
  const ScratchFile file("poses.csv", "t,name,x,y,z\n5,a,0,0,0\n5,b,1,0,0\n5.01,a,0,0,1\n5.02,b,1,0,1\n");
  const Ran ran = collide("publish " + file.path() + " --shards map.json");
  EXPECT_EQ(ran.code, 2);
  EXPECT_EQ(ran.err,
            "error: publish: a frame leaves objects out, so --shards is not for it: each frame says where all of them "
            "are\n       give every object a row at every time\n");
  EXPECT_EQ(fake::server().publishers.at(0).batches.size(), 2U)
      << "where they begin, and a frame; that one is not sent";
}

TEST_F(ShardedVerbs, ARobotAndAScanArePublishedToOneServer) {
  const Ran robot = collide("publish arm.urdf --joints plan.csv --shards map.json");
  EXPECT_EQ(robot.code, 2);
  EXPECT_EQ(robot.err, "error: publish: a robot is published to one server, so --shards is not for it\n");
  const Ran scan = collide("publish scan.pcd --voxels 5cm --shards map.json");
  EXPECT_EQ(scan.code, 2);
  EXPECT_EQ(scan.err, "error: publish: a scan is published to one server, so --shards is not for it\n");
  EXPECT_TRUE(fake::server().shard_map.empty()) << "it says so before it connects";
}

}  // namespace
}  // namespace collided
