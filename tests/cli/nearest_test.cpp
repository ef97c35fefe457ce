#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class NearestVerb : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }
  static const NearestQuestion& added() { return fake::server().nearest.back(); }
  static NearestEvent event(NearestEventKind kind, const std::string& from, const std::string& to) {
    NearestEvent event;
    event.kind = kind;
    event.nearest = "escape";
    event.from = from;
    event.to = to;
    event.sequence = 7;
    event.epoch = 1;
    event.world_time = std::chrono::seconds(100);
    event.bracket_low_s = 0.5;
    event.bracket_high_s = 0.25;
    event.distance_m = to.empty() ? 0 : 3;
    event.normal = Vec3(1, 0, 0);
    return event;
  }
};

TEST_F(NearestVerb, AnObjectOrAPointAndADistanceAreRead) {
  EXPECT_EQ(collide("nearest add escape 'door_*' person_7 20m --hysteresis 10cm --skip door_9 --keep").out, "escape\n");
  EXPECT_EQ(added().name, "escape");
  EXPECT_EQ(added().only, "door_*");
  EXPECT_EQ(added().to, "person_7");
  EXPECT_FALSE(added().point);
  EXPECT_EQ(added().within_m, 20);
  EXPECT_EQ(added().hysteresis_m, 0.1);
  EXPECT_EQ(added().skip, "door_9");
  EXPECT_TRUE(added().keep);
  EXPECT_EQ(collide("nearest add yard 'truck_*' 4 0 -1m 500cm --keep").out, "yard\n");
  EXPECT_EQ(added().to, "");
  EXPECT_EQ(*added().point, Vec3(4, 0, -1));
  EXPECT_EQ(added().within_m, 5);
}

TEST_F(NearestVerb, WhatIsNoQuestionIsRefusedAndNothingIsSent) {
  for (const char* wrong : {"q a", "q a b", "q a b 0", "q a b -1", "q a b inf", "q a b 5kg", "q a 1 2 5", "q a 1 2 x 5",
                            "q a b 5 --hysteresis -1cm", "q a 1 2 3 4 5"}) {
    const Ran ran = collide("nearest add " + std::string(wrong) + " --keep");
    EXPECT_EQ(ran.code, 2) << wrong;
    EXPECT_FALSE(ran.err.empty()) << wrong;
  }
  EXPECT_EQ(collide("nearest move q").code, 2);
  EXPECT_EQ(collide("nearest rm").code, 2);
  EXPECT_TRUE(fake::server().nearest.empty());
}

TEST_F(NearestVerb, OneThatIsNotKeptStandsAsLongAsItIsWatched) {
  fake::server().nearest_events = {event(NearestEventKind::changed, "door_1", "door_2")};
  const Ran ran = collide("nearest add escape 'door_*' person_7 20m -n 1");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_FALSE(added().keep);
  EXPECT_EQ(fake::server().nearest_watched_with.only, "escape");
  EXPECT_EQ(ran.out, "99.75\tchanged\tescape\tdoor_1\tdoor_2\t3\t\t\n");
}

TEST_F(NearestVerb, NewsSayFromWhomToWhomAndWhy) {
  fake::server().nearest_events = {event(NearestEventKind::is, "", "door_1"),
                                   event(NearestEventKind::changed, "door_1", "")};
  fake::server().nearest_events[1].reason = EndReason::removed;
  const Ran ran = collide("nearest watch 'e*' -n 2 --json");
  std::istringstream lines(ran.out);
  std::vector<nlohmann::json> all;
  for (std::string line; std::getline(lines, line);) all.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0]["what"], "is");
  EXPECT_EQ(all[0]["to"], "door_1");
  EXPECT_EQ(all[0]["distance"], 3);
  EXPECT_TRUE(all[0]["first_ns"].is_null());
  EXPECT_EQ(all[1]["from"], "door_1");
  EXPECT_TRUE(all[1]["to"].is_null());
  EXPECT_TRUE(all[1]["distance"].is_null());
  EXPECT_EQ(all[1]["why"], "removed");
  EXPECT_EQ(all[1]["first_ns"], 99'500'000'000);
  EXPECT_EQ(all[1]["last_ns"], 99'750'000'000);
}

TEST_F(NearestVerb, TheListHasTheAnswers) {
  ListedNearest listed;
  listed.question = {.name = "escape", .only = "door_*", .to = "person_7", .within_m = 20};
  listed.object = "door_2";
  listed.since = std::chrono::seconds(90);
  fake::server().listed_nearest = {listed};
  const auto row = nlohmann::json::parse(collide("nearest ls --json").out);
  EXPECT_EQ(row["nearest"], "escape");
  EXPECT_EQ(row["of"], "person_7");
  EXPECT_EQ(row["object"], "door_2");
  EXPECT_EQ(row["since"], 90);
  fake::server().listed_nearest.clear();
  EXPECT_EQ(collide("nearest").code, 1);
}

}  // namespace
}  // namespace collided
