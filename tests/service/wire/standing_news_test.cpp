// What a watch reports of standing questions, row by row.
#include "client/library/watching/standing_news.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/service/wire/standing_news_fixture.hpp"

namespace collided {
namespace {

// ---- what each row reports -----------------------------------------------------------------------------------------

TEST_F(StandingNewsTest, EveryRowIsOneEventOfItsOwnNumber) {
  using enum EndReason;
  const struct {
    StandingRow row;
    const char* line;
  } steps[] = {
      {{.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = 1}, "enter drone dock"},
      {{.kind = Kind::exit, .standing = kDock, .object = kDrone, .episode = 1, .reason = separated},
       "exit drone dock separated"},
      {{.kind = Kind::cross, .standing = kDock, .object = kDrone, .episode = 3}, "cross drone dock"},
      // Of a region that does not detect crossings.
      {{.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = 4}, "enter drone dock"},
      {{.kind = Kind::exit, .standing = kDock, .object = kDrone, .episode = 4, .reason = crossed},
       "exit drone dock crossed"},
      {{.kind = Kind::approach, .standing = kFar, .object = kDrone, .other = kPerson, .episode = 6, .band_m = 5},
       "approach drone person 5 gap"},
      {{.kind = Kind::near, .standing = kNear, .object = kDrone, .other = kPerson, .episode = 7, .band_m = 2},
       "near drone person 2 gap"},
      {{.kind = Kind::contact, .standing = kTouch, .object = kDrone, .other = kPerson, .episode = 8},
       "contact drone person 0 gap"},
      {{.kind = Kind::leave, .standing = kTouch, .object = kDrone, .other = kPerson, .episode = 8, .reason = separated},
       "leave drone person 0 gap separated"},
      {{.kind = Kind::leave,
        .standing = kFar,
        .object = kDrone,
        .other = kPerson,
        .episode = 6,
        .band_m = 5,
        .reason = removed},
       "leave drone person 5 gap removed"},
      {{.kind = Kind::changed, .standing = kEscape, .object = kDoorA}, "changed door_a escape"},
      {{.kind = Kind::changed,
        .standing = kEscape,
        .object = kDoorB,
        .other = kDoorA,
        .episode = 11,
        .reason = separated},
       "changed door_b (door_a) escape separated"},
      {{.kind = Kind::changed, .standing = kEscape, .other = kDoorB, .episode = 12, .reason = removed},
       "changed none (door_b) escape removed"},
      {{.kind = Kind::changed, .standing = kEscape, .object = kDoorC}, "changed door_c escape"},
  };
  hear_sum(0, {});
  std::uint64_t sequence = 0;
  for (const auto& step : steps) {
    hear(++sequence, step.row);
    const StandingEvent event = take_one();
    EXPECT_EQ(line_of(event), step.line);
    EXPECT_EQ(event.sequence, sequence);
    EXPECT_EQ(event.epoch, 1U);
    const bool begins = step.row.kind == Kind::changed && step.row.object != 0;
    EXPECT_EQ(event.episode, begins ? sequence : step.row.episode) << step.line;
    EXPECT_EQ(event.object_id, step.row.object);
  }
  // The watch holds what the server does.
  hear_sum(sequence, {{.standing = kNear, .object = kDrone, .episode = 7},
                      {.standing = kEscape, .object = kDoorC, .episode = sequence}});
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(state_.resyncs(), 0U);
}

TEST_F(StandingNewsTest, AFrameOfSeveralRowsIsReportedInTheirOrder) {
  hear_sum(0, {});
  hear(server_.frame(kStart_ns, 1,
                     {{.kind = Kind::changed, .standing = kEscape, .object = kDoorA},
                      {.kind = Kind::cross, .standing = kDock, .object = kDrone, .episode = 2},
                      {.kind = Kind::changed, .standing = kEscape, .object = kDoorB, .other = kDoorA, .episode = 1},
                      {.kind = Kind::enter, .standing = kDock, .object = kCrate, .episode = 4}}));
  const std::vector<StandingEvent> events = take();
  Lines reported;
  for (const StandingEvent& event : events) reported.push_back(std::to_string(event.sequence) + ' ' + line_of(event));
  EXPECT_EQ(reported, (Lines{"1 changed door_a escape", "2 cross drone dock", "3 changed door_b (door_a) escape",
                             "4 enter crate dock"}));
  hear(5, {.kind = Kind::exit, .standing = kDock, .object = kCrate, .episode = 4});
  EXPECT_EQ(lines(), Lines{"exit crate dock"});
  EXPECT_EQ(state_.gaps(), 0U);
}

TEST_F(StandingNewsTest, ACrossingHasBothBrackets) {
  hear_sum(0, {});
  hear(1, {.kind = Kind::cross,
           .standing = kDock,
           .object = kDrone,
           .episode = 1,
           .bracket_low_s = 0.2,
           .bracket_high_s = 0.1,
           .left_low_s = 0.08,
           .left_high_s = 0.07,
           .point = {1, 2, 3}});
  const StandingEvent cross = take_one();
  EXPECT_EQ(cross.bracket_low_s, 0.2);
  EXPECT_EQ(cross.bracket_high_s, 0.1);
  EXPECT_EQ(cross.left_low_s, 0.08);
  EXPECT_EQ(cross.left_high_s, 0.07);
  EXPECT_EQ(cross.point, Vec3(1, 2, 3));
  EXPECT_EQ(cross.world_time.count(), kStart_ns);
  EXPECT_EQ(cross.entered.count(), kStart_ns - 100'000'000);
}

TEST_F(StandingNewsTest, AnExitHasTheTimeOfTheEntry) {
  hear_sum(0, {});
  hear(1, {.kind = Kind::enter,
           .standing = kDock,
           .object = kDrone,
           .episode = 1,
           .bracket_low_s = 0.2,
           .bracket_high_s = 0.1});
  const StandingEvent entered = take_one();
  EXPECT_EQ(entered.bracket_low_s, 0.2);
  EXPECT_EQ(entered.bracket_high_s, 0.1);
  EXPECT_EQ(entered.left_high_s, 0);
  hear(server_.frame(kStart_ns + 5'000'000'000, 2,
                     {{.kind = Kind::exit, .standing = kDock, .object = kDrone, .episode = 1, .bracket_low_s = 0.04}}));
  const StandingEvent left = take_one();
  EXPECT_EQ(left.entered.count(), kStart_ns - 100'000'000);
  EXPECT_EQ(left.world_time.count(), kStart_ns + 5'000'000'000);
  EXPECT_EQ(left.bracket_low_s, 0.04);
}

TEST_F(StandingNewsTest, WhatAQuestionDoesNotDetectIsNotReportedButHolds) {
  hear_sum(0, {});
  hear(1, {.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = 1, .detect = codes::kDetectExit});
  EXPECT_EQ(lines(), Lines{});
  hear_sum(1, {{.standing = kDock, .object = kDrone, .episode = 1}});
  EXPECT_TRUE(state_.in_step());
  hear(2, {.kind = Kind::exit, .standing = kDock, .object = kDrone, .episode = 1, .reason = EndReason::removed});
  EXPECT_EQ(lines(), Lines{"exit drone dock removed"});
  hear(3, {.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = 3});
  hear(4, {.kind = Kind::exit, .standing = kDock, .object = kDrone, .episode = 3, .detect = codes::kDetectEnter});
  EXPECT_EQ(lines(), Lines{"enter drone dock"});
  hear_sum(4, {});
  EXPECT_TRUE(state_.in_step());
  EXPECT_EQ(state_.resyncs(), 0U);
}

TEST_F(StandingNewsTest, MergedPosesAreMarkedAndAreNoDoubt) {
  hear_sum(0, {});
  std::uint64_t before = 0;
  for (const std::uint8_t marks : {std::uint8_t{0}, wire_contract::kDoubtPosesMerged}) {
    const StandingRow rows[] = {
        {.kind = Kind::enter, .standing = kDock, .object = kDrone, .episode = before + 1},
        {.kind = Kind::exit, .standing = kDock, .object = kDrone, .episode = before + 1},
        {.kind = Kind::cross, .standing = kDock, .object = kDrone, .episode = before + 3},
        {.kind = Kind::near, .standing = kNear, .object = kDrone, .other = kPerson, .episode = before + 4, .band_m = 2},
        {.kind = Kind::leave,
         .standing = kNear,
         .object = kDrone,
         .other = kPerson,
         .episode = before + 4,
         .band_m = 2},
        {.kind = Kind::changed, .standing = kEscape, .object = kDoorA},
        {.kind = Kind::changed, .standing = kEscape, .object = kDoorB, .other = kDoorA, .episode = before + 6},
        {.kind = Kind::changed, .standing = kEscape, .other = kDoorB, .episode = before + 7},
    };
    for (StandingRow row : rows) {
      row.doubt = marks;
      hear(++before, row);
      const StandingEvent event = take_one();
      EXPECT_EQ(event.poses_merged, marks != 0) << line_of(event);
      EXPECT_EQ(event.doubt, Doubt::none) << line_of(event);
    }
  }
}

// ---- distances and doubts ------------------------------------------------------------------------------------------

TEST_F(StandingNewsTest, ABandHasTheDistanceAndAForecast) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  hear_sum(0, {});
  StandingRow near{.kind = Kind::near,
                   .standing = kNear,
                   .object = kDrone,
                   .other = kPerson,
                   .episode = 1,
                   .band_m = 2.5,
                   .point = {1, 2, 3},
                   .normal = {1, 0, 0},
                   .distance_m = 2.5,
                   .distance_error_m = 1e-9,
                   .closing = 2,
                   .closing_error = 0.125,
                   .contact_low_s = 1,
                   .contact_high_s = 1.5};
  hear(1, near);
  const StandingEvent event = take_one();
  EXPECT_EQ(event.form, StandingForm::bands);
  EXPECT_EQ(event.band_m, 2.5);
  EXPECT_EQ(event.point, Vec3(1, 2, 3));
  EXPECT_EQ(event.normal, Vec3(1, 0, 0));
  EXPECT_EQ(event.distance_m, 2.5);
  EXPECT_EQ(event.distance_error_m, 1e-9);
  EXPECT_EQ(event.closing_mps, 2);
  EXPECT_EQ(event.closing_error_mps, 0.125);
  ASSERT_TRUE(event.contact_in);
  EXPECT_EQ(event.contact_in->low_s, 1);
  EXPECT_EQ(event.contact_in->high_s, 1.5);
  near.standing = kFar;
  near.band_m = 5;
  near.kind = Kind::approach;
  near.episode = 2;
  near.contact_low_s = near.contact_high_s = kNever;
  hear(2, near);
  EXPECT_FALSE(take_one().contact_in) << "they do not meet";
}

TEST_F(StandingNewsTest, TheNearestHasTheDistance) {
  hear_sum(0, {});
  hear(1, {.kind = Kind::changed,
           .standing = kEscape,
           .object = kDoorA,
           .point = {1, 2, 3},
           .normal = {0, 1, 0},
           .distance_m = 2,
           .distance_error_m = 1e-12});
  const StandingEvent nearest = take_one();
  EXPECT_EQ(nearest.distance_m, 2);
  EXPECT_EQ(nearest.distance_error_m, 1e-12);
  EXPECT_EQ(nearest.point, Vec3(1, 2, 3));
  EXPECT_EQ(nearest.normal, Vec3(0, 1, 0));
  EXPECT_FALSE(nearest.contact_in);
  hear(2, {.kind = Kind::changed, .standing = kEscape, .other = kDoorA, .episode = 1});
  EXPECT_EQ(take_one().distance_m, 0) << "none is nearest";
}

// Whether it holds is not known, so it is reported as if it did, without the numbers that mean nothing then.
TEST_F(StandingNewsTest, ADoubtIsReportedWithoutADistance) {
  hear_sum(0, {});
  const StandingRow rows[] = {
      {.kind = Kind::enter, .standing = kDock, .object = kDrone},
      {.kind = Kind::near, .standing = kNear, .object = kDrone, .other = kPerson, .band_m = 2},
      {.kind = Kind::changed, .standing = kEscape, .object = kDoorA},
  };
  std::uint64_t sequence = 0;
  for (StandingRow row : rows) {
    row.episode = ++sequence;
    row.doubt = static_cast<std::uint8_t>(Doubt::publisher_lost);
    row.distance_m = row.distance_error_m = row.closing = row.closing_error = 7;
    row.contact_low_s = row.contact_high_s = 7;
    hear(sequence, row);
    const StandingEvent event = take_one();
    EXPECT_EQ(event.kind, row.kind);
    EXPECT_EQ(event.doubt, Doubt::publisher_lost);
    EXPECT_EQ(event.distance_m, 0);
    EXPECT_EQ(event.distance_error_m, 0);
    EXPECT_EQ(event.closing_mps, 0);
    EXPECT_EQ(event.closing_error_mps, 0);
    EXPECT_FALSE(event.contact_in);
  }
  // Where a doubt is decided the same object is the nearest again.
  hear(4, {.kind = Kind::changed,
           .standing = kEscape,
           .object = kDoorA,
           .other = kDoorA,
           .episode = 3,
           .reason = EndReason::decided,
           .distance_m = 2});
  const StandingEvent decided = take_one();
  EXPECT_EQ(line_of(decided), "changed door_a (door_a) escape decided");
  EXPECT_EQ(decided.distance_m, 2);
  hear(5, {.kind = Kind::changed,
           .standing = kEscape,
           .other = kDoorA,
           .episode = 4,
           .doubt = static_cast<std::uint8_t>(Doubt::publisher_lost)});
  EXPECT_EQ(take_one().doubt, Doubt::none) << "that none is nearest is known";
}

// ---- which are asked for -------------------------------------------------------------------------------------------

TEST(StandingNewsWanted, OptionsChooseByTheQuestionAndBothObjects) {
  const StandingEvent event{.form = StandingForm::bands, .standing = "gap", .object = "drone", .other = "person"};
  for (const char* glob : {"", "gap", "dro*", "person", "*"})
    EXPECT_TRUE(client::is_wanted(event, {.only = glob})) << glob;
  EXPECT_FALSE(client::is_wanted(event, {.only = "robot*"}));
  for (const char* glob : {"gap", "dro*", "person", "*"})
    EXPECT_FALSE(client::is_wanted(event, {.skip = glob})) << glob;
  EXPECT_TRUE(client::is_wanted(event, {.skip = "robot*", .form = StandingForm::bands}));
  EXPECT_FALSE(client::is_wanted(event, {.form = StandingForm::region}));
}

}  // namespace
}  // namespace collided
