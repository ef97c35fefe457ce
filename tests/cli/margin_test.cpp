#include <gtest/gtest.h>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

class MarginVerb : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }
  static const Margin& added() { return fake::server().margins.back(); }
  static MarginEvent event(MarginEventKind kind, double band_m) {
    MarginEvent event;
    event.kind = kind;
    event.margin = "close";
    event.object = "drone_1";
    event.around = "person_2";
    event.band_m = band_m;
    event.sequence = 7;
    event.episode = 3;
    event.epoch = 1;
    event.world_time = std::chrono::seconds(100);
    event.entered = std::chrono::seconds(90);
    event.bracket_low_s = 0.5;
    event.bracket_high_s = 0.25;
    event.distance_m = band_m;
    event.normal = Vec3(1, 0, 0);
    event.closing_mps = 4;
    event.contact_in = {0.5, 0.500001};
    return event;
  }
};

TEST_F(MarginVerb, BandsAreReadWithTheirUnitsAndKept) {
  EXPECT_EQ(collide("margin add close 'drone*' 'person*' 5m,2,50cm --hysteresis 10cm --dwell 200ms --keep").out,
            "close\n");
  EXPECT_EQ(added().name, "close");
  EXPECT_EQ(added().around, "drone*");
  EXPECT_EQ(added().only, "person*");
  EXPECT_EQ(added().bands_m, (std::vector<double>{5, 2, 0.5}));
  EXPECT_EQ(added().hysteresis_m, 0.1);
  EXPECT_EQ(added().dwell, std::chrono::milliseconds(200));
  EXPECT_TRUE(added().keep);
}

// A glob that names parts of a scene would be silent for ever otherwise.
TEST_F(MarginVerb, PartsOfScenesAreSaidToHaveNoBands) {
  EXPECT_EQ(collide("margin add close 'drone*' 'plant/*' 5 --keep").err, "");
  fake::server().margin_parts = 312;
  EXPECT_EQ(collide("margin add close 'drone*' 'plant/*' 5 --keep").err,
            "warning: 312 parts of loaded scenes match and have no bands; give what stands still a shape of its own: "
            "collide add\n");
  fake::server().margin_parts = 1;
  EXPECT_EQ(
      collide("margin add close 'drone*' plant/tank 5 --keep").err.find("warning: 1 part of loaded scenes matches"),
      0u);
}

TEST_F(MarginVerb, WhatIsNoMarginIsRefusedAndNothingIsSent) {
  for (const char* wrong :
       {"close a", "close a b", "close a b 2m,5m", "close a b 2m,2m", "close a b -1", "close a b inf", "close a b nan",
        "close a b 5kg", "close a b 5 --hysteresis -1cm", "close a b 5 --hysteresis inf", "close a b 5 --dwell -1s"}) {
    const Ran ran = collide("margin add " + std::string(wrong) + " --keep");
    EXPECT_EQ(ran.code, 2) << wrong;
    EXPECT_FALSE(ran.err.empty()) << wrong;
  }
  EXPECT_NE(collide("margin add close a b 2m,5m --keep").err.find("band 2, 5 m, is not less than the one before it"),
            std::string::npos);
  EXPECT_EQ(collide("margin move close").code, 2);
  EXPECT_EQ(collide("margin rm").code, 2);
  EXPECT_TRUE(fake::server().margins.empty());
}

TEST_F(MarginVerb, OneThatIsNotKeptStandsAsLongAsItIsWatched) {
  fake::server().margin_events = {event(MarginEventKind::approach, 5)};
  const Ran ran = collide("margin add close 'drone*' 'person*' 5m -n 1");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_FALSE(added().keep);
  EXPECT_EQ(fake::server().margins_watched_with.only, "close");
  EXPECT_EQ(ran.out, "99.75\tapproach\tclose\tdrone_1\tperson_2\t5\t4\t0.5\t\t\t\n");
}

TEST_F(MarginVerb, NewsAreToldWithWhatComesNext) {
  fake::server().margin_events = {event(MarginEventKind::within, 5), event(MarginEventKind::near, 2),
                                  event(MarginEventKind::leave, 2)};
  fake::server().margin_events[2].reason = EndReason::separated;
  const Ran ran = collide("margin watch 'c*' -n 3 --json");
  std::istringstream lines(ran.out);
  std::vector<nlohmann::json> all;
  for (std::string line; std::getline(lines, line);) all.push_back(nlohmann::json::parse(line));
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0]["what"], "within");
  EXPECT_EQ(all[0]["time"], 90);
  EXPECT_EQ(all[1]["what"], "near");
  EXPECT_EQ(all[1]["distance"], 2);
  EXPECT_EQ(all[1]["closing"], 4);
  EXPECT_EQ(all[1]["contact_in_first"], 0.5);
  EXPECT_EQ(all[1]["first_ns"], 99'500'000'000);
  EXPECT_EQ(all[1]["last_ns"], 99'750'000'000);
  EXPECT_EQ(all[2]["why"], "separated");
  EXPECT_EQ(all[2]["after"], 9.75);
  EXPECT_FALSE(all[2].contains("distance") && !all[2]["distance"].is_null());
}

TEST_F(MarginVerb, PeopleReadWhoComesNearAndHowSoonTheyTouch) {
  fake::server().margin_events = {event(MarginEventKind::near, 2), event(MarginEventKind::contact, 0)};
  const std::string text = at_terminal("margin watch -n 2").out;
  EXPECT_NE(text.find("close  drone_1 x person_2  2 m  closing 4 m/s  contact in 500 ms"), std::string::npos) << text;
  EXPECT_NE(text.find("contact"), std::string::npos) << text;
}

TEST_F(MarginVerb, TheListSaysWhoIsNear) {
  const Ran none = collide("margin ls");
  EXPECT_EQ(none.code, 1);
  EXPECT_EQ(none.out, "");
  EXPECT_EQ(none.err, "no margins; 'collide margin add' makes one\n");
  fake::server().listed_margins = {{.margin = {.name = "close",
                                               .around = "drone*",
                                               .only = "person*",
                                               .bands_m = {5, 2, 0},
                                               .hysteresis_m = 0.1,
                                               .dwell = std::chrono::milliseconds(200),
                                               .keep = true},
                                    .pairs = {{.object = "person_2", .around = "drone_1", .within_m = 2},
                                              {.object = "person_3", .around = "drone_1", .within_m = 0}}}};
  const std::string table = at_terminal("margin ls").out;
  EXPECT_NE(table.find("5 m, 2 m"), std::string::npos) << table;
  EXPECT_NE(table.find("person_2 drone_1 2 m  person_3 drone_1 contact"), std::string::npos) << table;
  EXPECT_EQ(nlohmann::json::parse(collide("margin ls --json").out)["dwell"], 0.2);
  collide("margin add close a b 1 --keep");
  EXPECT_EQ(collide("margin rm close").out, "1\n");
  EXPECT_EQ(collide("margin rm close").code, 1) << "it has gone";
}

}  // namespace
}  // namespace collided
