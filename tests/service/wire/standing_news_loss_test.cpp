// What a watch reports of standing questions when it joins, where messages are lost and where they come again.
#include "client/library/watching/standing_news.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/service/wire/standing_news_fixture.hpp"

namespace collided {
namespace {

// ---- what holds already --------------------------------------------------------------------------------------------

TEST_F(StandingNewsTest, WhatHoldsAlreadyComesFirst) {
  hear_state(9, {{.standing = kDock, .object = kCrate, .episode = 2, .began_ns = kStart_ns - 7, .point = {1, 2, 3}},
                 {.form = StandingForm::bands,
                  .standing = kNear,
                  .object = kDrone,
                  .other = kPerson,
                  .episode = 5,
                  .band_m = 2,
                  .began_ns = kStart_ns - 5},
                 {.form = StandingForm::nearest,
                  .standing = kEscape,
                  .object = kDoorA,
                  .episode = 7,
                  .began_ns = kStart_ns - 3,
                  .distance_m = 2,
                  .distance_error_m = 0.5}});
  std::map<std::string, StandingEvent> events;
  for (const StandingEvent& event : take()) events[line_of(event)] = event;
  ASSERT_EQ(events.size(), 3U);
  EXPECT_TRUE(state_.in_step());
  const StandingEvent& inside = events["inside crate dock resync"];
  EXPECT_EQ(inside.entered.count(), kStart_ns - 7);
  EXPECT_EQ(inside.episode, 2U);
  EXPECT_EQ(inside.sequence, 9U);
  EXPECT_EQ(inside.point, Vec3(1, 2, 3));
  EXPECT_EQ(events["within drone person 2 gap resync"].episode, 5U);
  const StandingEvent& nearest = events["is door_a escape resync"];
  EXPECT_EQ(nearest.distance_m, 2);
  EXPECT_EQ(nearest.distance_error_m, 0.5);
  hear(10, {.kind = Kind::changed, .standing = kEscape, .object = kDoorB, .other = kDoorA, .episode = 7});
  EXPECT_EQ(lines(), Lines{"changed door_b (door_a) escape"});
}

// A change of the nearest concerns two shards: that of the one before, which was written, and that of the next one, which was
// not yet.
TEST_F(StandingNewsTest, AChangeOfTheNearestCountsForBothShards) {
  ASSERT_NE(wire_contract::contact_shard(kDoorA, kEscape), wire_contract::contact_shard(kDoorB, kEscape));
  hear(server_.shard(kStart_ns, wire_contract::contact_shard(kDoorA, kEscape), 1,
                     {{.form = StandingForm::nearest, .standing = kEscape, .object = kDoorA, .episode = 1}}));
  hear(2, {.kind = Kind::changed, .standing = kEscape, .object = kDoorB, .other = kDoorA, .episode = 1});
  hear_sum(2, {{.form = StandingForm::nearest, .standing = kEscape, .object = kDoorB, .episode = 2}});
  EXPECT_TRUE(state_.in_step());
  const StandingEvent nearest = take_one();
  EXPECT_EQ(nearest.kind, Kind::is);
  EXPECT_EQ(nearest.object, "door_b");
}

// ---- losses --------------------------------------------------------------------------------------------------------

TEST_F(StandingNewsTest, AnExitWhoseEntryWasLostComesAfterIt) {
  hear_sum(0, {});
  hear(2, {.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = 2});  // 1: the crate came in
  EXPECT_EQ(lines(), Lines{"enter drone dock"});
  EXPECT_FALSE(state_.in_step());
  hear(3, {.kind = Kind::exit, .standing = kDock, .object = kCrate, .episode = 1});
  EXPECT_EQ(lines(), (Lines{"enter crate dock resync", "exit crate dock"}));
  hear_state(3, {{.standing = kDock, .object = kDrone, .episode = 2}});
  EXPECT_EQ(lines(), Lines{});
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(state_.gaps(), 1U);
}

TEST_F(StandingNewsTest, ACrossingAfterALostExitComesAfterIt) {
  hear_sum(0, {});
  hear(1, {.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = 1});
  hear(3, {.kind = Kind::cross, .standing = kDock, .object = kDrone, .episode = 3});  // 2: the drone went out
  EXPECT_EQ(lines(), (Lines{"enter drone dock", "exit drone dock resync", "cross drone dock"}));
  hear_state(3, {});
  EXPECT_EQ(lines(), Lines{});
  EXPECT_TRUE(state_.in_step());
}

TEST_F(StandingNewsTest, ALostChangeOfTheNearestIsReportedBeforeTheNext) {
  hear_sum(0, {});
  hear(1, {.kind = Kind::changed, .standing = kEscape, .object = kDoorA});
  // 2: door_b came in the place of door_a
  hear(3, {.kind = Kind::changed,
           .standing = kEscape,
           .object = kDoorC,
           .other = kDoorB,
           .episode = 2,
           .reason = EndReason::separated});
  EXPECT_EQ(lines(), (Lines{"changed door_a escape", "changed door_b (door_a) escape resync",
                            "changed door_c (door_b) escape separated"}));
  hear_state(3, {{.form = StandingForm::nearest, .standing = kEscape, .object = kDoorC, .episode = 3}});
  EXPECT_EQ(lines(), Lines{});
  EXPECT_TRUE(state_.in_step());
}

// The sum has more than the watch, and no event follows that would show the gap.
TEST_F(StandingNewsTest, TheSumShowsWhatWasLostLast) {
  hear_sum(0, {});
  hear(1, {.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = 1});
  hear(2, {.kind = Kind::changed, .standing = kEscape, .object = kDoorA});
  static_cast<void>(take());
  // 3: the drone went out; 4: the crate came in; 5: door_b came in the place of door_a
  hear_state(5, {{.standing = kDock, .object = kCrate, .episode = 4},
                 {.form = StandingForm::nearest, .standing = kEscape, .object = kDoorB, .episode = 5}});
  EXPECT_TRUE(state_.in_step());
  std::set<std::string> kinds;
  std::string nearest;
  for (const StandingEvent& event : take()) {
    EXPECT_TRUE(event.resync) << line_of(event);
    if (event.form == StandingForm::region) kinds.insert(line_of(event));
    else nearest = event.object;
  }
  EXPECT_EQ(kinds, (std::set<std::string>{"exit drone dock resync", "enter crate dock resync"}));
  EXPECT_EQ(nearest, "door_b");
  EXPECT_EQ(state_.resyncs(), 1U);
}

TEST_F(StandingNewsTest, WhatWasLostIsReportedAsItsQuestionWouldHave) {
  hear_sum(0, {});
  hear(1, {.kind = Kind::enter,
           .standing = kDock,
           .object = kDrone,
           .episode = 1,
           .detect = codes::kDetectEnter | codes::kDetectCross});
  EXPECT_EQ(lines(), Lines{"enter drone dock"});
  // 2: the drone went out, which the dock does not report; 3: the crate came in; 4: the drone came into the widest band
  hear_state(4, {{.standing = kDock, .object = kCrate, .episode = 3, .detect = codes::kDetectExit},
                 {.kind = Kind::approach,
                  .form = StandingForm::bands,
                  .standing = kFar,
                  .object = kDrone,
                  .other = kPerson,
                  .episode = 4,
                  .band_m = 5}});
  EXPECT_EQ(lines(), Lines{"approach drone person 5 gap resync"});
  hear(5, {.kind = Kind::exit, .standing = kDock, .object = kCrate, .episode = 3, .detect = codes::kDetectExit});
  EXPECT_EQ(lines(), Lines{"exit crate dock"});
}

TEST_F(StandingNewsTest, ASumThatDisagreesStartsAResync) {
  hear_sum(0, {});
  hear(1, {.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = 1});
  hear_sum(1, {{.standing = kDock, .object = kDrone, .episode = 1}});
  EXPECT_TRUE(state_.in_step());
  hear_sum(1, {{.standing = kDock, .object = kCrate, .episode = 1}});
  EXPECT_FALSE(state_.in_step());
}

// ---- heard again ---------------------------------------------------------------------------------------------------

TEST_F(StandingNewsTest, FramesThatOverlapReportEachEventOnce) {
  const StandingRow enter{.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = 1};
  const StandingRow cross{.kind = Kind::cross, .standing = kDock, .object = kCrate, .episode = 2};
  const StandingRow changed{.kind = Kind::changed, .standing = kEscape, .object = kDoorA};
  hear_sum(0, {});
  hear(server_.frame(kStart_ns, 1, {enter, cross}));
  hear(server_.frame(kStart_ns, 1, {enter, cross}));
  hear(server_.frame(kStart_ns, 2, {cross, changed}));
  EXPECT_EQ(lines(), (Lines{"enter drone dock", "cross crate dock", "changed door_a escape"}));
  EXPECT_EQ(state_.resyncs(), 0U);
}

// The heir has ids and numbers of its own for the same events.
TEST_F(StandingNewsTest, WhatAnHeirReportsAgainIsReportedOnce) {
  constexpr std::uint64_t kAfter = 100;  // between the numbers of the two
  const auto rows = [](std::uint64_t before) -> std::vector<StandingRow> {
    return {{.kind = Kind::enter,
             .standing = kDock,
             .object = kDrone,
             .episode = before + 1,
             .bracket_low_s = 0.9,
             .bracket_high_s = 0.9},
            {.kind = Kind::cross,
             .standing = kDock,
             .object = kCrate,
             .episode = before + 2,
             .bracket_low_s = 0.8,
             .bracket_high_s = 0.8,
             .left_low_s = 0.7,
             .left_high_s = 0.7},
            {.kind = Kind::changed, .standing = kEscape, .object = kDoorA, .bracket_low_s = 0.6, .bracket_high_s = 0.6},
            {.kind = Kind::changed,
             .standing = kEscape,
             .object = kDoorB,
             .other = kDoorA,
             .episode = before + 3,
             .reason = EndReason::separated,
             .bracket_low_s = 0.5,
             .bracket_high_s = 0.5},
            {.kind = Kind::approach,
             .standing = kFar,
             .object = kDrone,
             .other = kPerson,
             .episode = before + 5,
             .band_m = 5,
             .bracket_low_s = 0.4,
             .bracket_high_s = 0.4}};
  };
  hear(server_.sum(kStart_ns - 2'000'000'000, 0, {}));
  hear(server_.frame(kStart_ns, 1, rows(0)));
  EXPECT_EQ(take().size(), 5U);

  server_ = {.server = 2, .epoch = 2, .names = server_.names};
  auto again = server_.frame(kStart_ns, kAfter + 1, rows(kAfter));
  again.sample->version = 0;
  hear(std::move(again));
  EXPECT_EQ(lines(), Lines{});
  hear_state(kAfter + 5,
             {{.standing = kDock, .object = kDrone, .episode = kAfter + 1, .began_ns = kStart_ns - 900'000'000},
              {.form = StandingForm::nearest,
               .standing = kEscape,
               .object = kDoorB,
               .episode = kAfter + 4,
               .began_ns = kStart_ns - 500'000'000},
              {.form = StandingForm::bands,
               .standing = kFar,
               .object = kDrone,
               .other = kPerson,
               .episode = kAfter + 5,
               .band_m = 5,
               .began_ns = kStart_ns - 400'000'000}});
  EXPECT_EQ(lines(), Lines{});
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(state_.gaps(), 0U);
  EXPECT_EQ(state_.life_change().heard_from, kAfter + 1);

  hear(server_.frame(
      kStart_ns + 1'000'000'000, kAfter + 6,
      {{.kind = Kind::exit, .standing = kDock, .object = kDrone, .episode = kAfter + 1},
       {.kind = Kind::changed, .standing = kEscape, .object = kDoorC, .other = kDoorB, .episode = kAfter + 4},
       {.kind = Kind::leave,
        .standing = kFar,
        .object = kDrone,
        .other = kPerson,
        .episode = kAfter + 5,
        .band_m = 5}}));
  const std::vector<StandingEvent> events = take();
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(line_of(events[0]), "exit drone dock");
  EXPECT_EQ(events[0].entered.count(), kStart_ns - 900'000'000) << "as the first server reported it";
  EXPECT_EQ(line_of(events[1]), "changed door_c (door_b) escape");
  EXPECT_EQ(line_of(events[2]), "leave drone person 5 gap");
}

// What held before the takeover had ended when the object crossed.
TEST_F(StandingNewsTest, ACrossingAfterATakeoverEndsWhatHeld) {
  hear_sum(0, {});
  hear(1, {.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = 1});
  server_ = {.server = 2, .epoch = 2, .names = server_.names};
  hear(server_.frame(kStart_ns + 5'000'000'000, 1,
                     {{.kind = Kind::cross, .standing = kDock, .object = kDrone, .episode = 1}}));
  EXPECT_EQ(lines(), (Lines{"enter drone dock", "exit drone dock resync", "cross drone dock"}));
  hear_state(1, {});
  EXPECT_EQ(lines(), Lines{});
  EXPECT_TRUE(state_.in_step());
}

}  // namespace
}  // namespace collided
