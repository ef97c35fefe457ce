#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class FenceVerb : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }
  static const Fence& added() { return fake::server().fences.back(); }
  static FenceEvent event(FenceEventKind kind) {
    FenceEvent event;
    event.kind = kind;
    event.object = "forklift_2";
    event.fence = "dock";
    event.sequence = 7;
    event.episode = 3;
    event.epoch = 1;
    event.world_time = std::chrono::seconds(100);
    event.entered = std::chrono::seconds(90);
    event.bracket_low_s = 0.5;
    event.bracket_high_s = 0.25;
    event.left_low_s = 0.125;
    event.left_high_s = 0.0625;
    return event;
  }
};

TEST_F(FenceVerb, RegionsAreReadInMetresAndKept) {
  EXPECT_EQ(collide("fence add dock box 0 0 0 5 4 3m --only 'forklift*' --keep").out, "dock\n");
  EXPECT_EQ(added().name, "dock");
  EXPECT_EQ(added().only, "forklift*");
  EXPECT_TRUE(added().keep);
  EXPECT_TRUE(added().enter && added().exit && added().cross);
  EXPECT_EQ(std::get<BoxShape>(added().shape.at(0)).half_m, Vec3(2.5, 2, 1.5));
  EXPECT_EQ(std::get<BoxShape>(added().shape.at(0)).center, Vec3(2.5, 2, 1.5));
  collide("fence add zone sphere 1 2 3 50cm --to person --detect enter --keep");
  EXPECT_EQ(std::get<SphereShape>(added().shape.at(0)).radius_m, 0.5);
  EXPECT_EQ(added().to, "person");
  EXPECT_TRUE(added().enter && !added().exit && !added().cross);
  collide("fence add yard prism -1 2 0 0 4 0 4 4 --keep");
  ASSERT_TRUE(added().prism);
  EXPECT_EQ(added().prism->low_m, -1);
  EXPECT_EQ(added().prism->corners.size(), 3u);
  collide("fence add ground plane 0 0 0 0 0 1 --keep");
  EXPECT_EQ(std::get<HalfSpaceShape>(added().shape.at(0)).normal, Vec3(0, 0, 1));
}

TEST_F(FenceVerb, WhatIsNoRegionIsRefusedAndNothingIsSent) {
  for (const char* wrong : {"box 0 0 0", "sphere 1 2 3", "prism 0 1 0 0 1 0", "prism 0 1 0 0 1 0 1", "pyramid 1 2 3",
                            "box 0 0 0 inf 1 1", "box 0 0 0 1 1 nan"}) {
    const Ran ran = collide("fence add dock " + std::string(wrong) + " --keep");
    EXPECT_EQ(ran.code, 2) << wrong;
    EXPECT_FALSE(ran.err.empty()) << wrong;
  }
  EXPECT_EQ(collide("fence add dock box 0 0 0 1 1 1 --keep --detect enter,leave").code, 2);
  EXPECT_EQ(collide("fence move dock").code, 2);
  EXPECT_EQ(collide("fence rm").code, 2);
  EXPECT_TRUE(fake::server().fences.empty());
}

TEST_F(FenceVerb, OneThatIsNotKeptStandsAsLongAsItIsWatched) {
  fake::server().fence_events = {event(FenceEventKind::enter)};
  const Ran ran = collide("fence add dock box 0 0 0 5 4 3 -n 1");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_FALSE(added().keep);
  EXPECT_EQ(fake::server().fences_watched_with.only, "dock");
  EXPECT_EQ(ran.out, "99.75\tenter\tforklift_2\tdock\t\t\t\n");
}

TEST_F(FenceVerb, NewsAreToldWithTheirBrackets) {
  fake::server().fence_events = {event(FenceEventKind::inside), event(FenceEventKind::exit),
                                 event(FenceEventKind::cross)};
  fake::server().fence_events[1].reason = EndReason::separated;
  const Ran ran = collide("fence watch 'd*' -n 3 --json");
  EXPECT_EQ(fake::server().fences_watched_with.only, "d*");
  std::istringstream lines(ran.out);
  std::vector<nlohmann::json> all;
  for (std::string line; std::getline(lines, line);) all.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0]["what"], "inside");
  EXPECT_EQ(all[0]["time"], 90);
  EXPECT_EQ(all[1]["why"], "separated");
  EXPECT_EQ(all[1]["after"], 9.75);
  EXPECT_EQ(all[1]["first_ns"], 99'500'000'000);
  EXPECT_EQ(all[1]["last_ns"], 99'750'000'000);
  EXPECT_EQ(all[2]["left_first_ns"], 99'875'000'000);
  EXPECT_EQ(all[2]["left_last_ns"], 99'937'500'000);
}

TEST_F(FenceVerb, TheListSaysWhoIsInside) {
  const Ran none = collide("fence ls");
  EXPECT_EQ(none.code, 1);
  EXPECT_EQ(none.out, "");
  EXPECT_EQ(none.err, "no fences; 'collide fence add' makes one\n");
  fake::server().listed_fences = {{.name = "dock",
                                   .kind = "box",
                                   .to = "",
                                   .only = "forklift*",
                                   .skip = "",
                                   .enter = true,
                                   .exit = true,
                                   .cross = false,
                                   .keep = true,
                                   .inside = {"forklift_1", "forklift_2"},
                                   .in_doubt = {"forklift_9"}}};
  const std::string table = at_terminal("fence ls").out;
  EXPECT_NE(table.find("forklift_1 forklift_2  in doubt: forklift_9"), std::string::npos) << table;
  EXPECT_EQ(nlohmann::json::parse(collide("fence ls --json").out)["tells"], "enter,exit");
  collide("fence add dock box 0 0 0 1 1 1 --keep");
  EXPECT_EQ(collide("fence rm dock").out, "1\n");
  EXPECT_EQ(collide("fence rm dock").code, 1) << "it has gone";
}

}  // namespace
}  // namespace collided
