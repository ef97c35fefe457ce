// What standing questions of every form have in common: how long they stay, how they are listed and removed, what is refused.
#include <csignal>

#include "tests/service/standing_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ServerStanding : public testing_support::StandingTest {
 protected:
  static std::string refusal(Client& client, const Standing& standing) {
    const Result<AddedStanding> added = client.add(standing);
    return added ? "" : added.error().message;
  }
};

TEST_F(ServerStanding, FormsAreListedAndRemovedApartOrTogether) {
  start();
  Client client = connect();
  for (const Standing& one : {dock(), close({5}), escape()}) ASSERT_TRUE(client.add(one)) << one.name;
  EXPECT_EQ(names(client), (Names{"close", "dock", "escape"}));
  EXPECT_EQ(names(client, "*", StandingForm::region), Names{"dock"});
  EXPECT_EQ(names(client, "", StandingForm::bands), Names{"close"});
  EXPECT_EQ(names(client, "escape", StandingForm::bands), Names());
  EXPECT_EQ(*client.remove_standing("*", StandingForm::region), 1u);
  EXPECT_EQ(names(client), (Names{"close", "escape"}));
  EXPECT_EQ(*client.remove_standing("close", StandingForm::nearest), 0u);
  EXPECT_EQ(*client.remove_standing("*"), 2u);
  EXPECT_EQ(names(client), Names());
}

TEST_F(ServerStanding, AListHasWhatWasAskedForWhenItWasAdded) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(Standing{.name = "dock",
                                  .only = "drone*",
                                  .skip = "*_x",
                                  .mask = 6,
                                  .keep = true,
                                  .of = Region{.shape = {SphereShape{.radius_m = 1}}, .to = "ship", .cross = false}}));
  ASSERT_TRUE(client.add(Standing{.name = "close",
                                  .only = "b",
                                  .of = Bands{.around = "a", .bands_m = {5, 2}, .hysteresis_m = 0.5, .dwell = 200ms}}));
  ASSERT_TRUE(client.add(Standing{
      .name = "first", .only = "c*", .of = Nearest{.point = Vec3(1, 2, 3), .within_m = 9, .hysteresis_m = 0.25}}));
  const ListedStanding region = client.standing("dock")->at(0);
  EXPECT_EQ(region.form, StandingForm::region);
  EXPECT_EQ(region.only, "drone*");
  EXPECT_EQ(region.skip, "*_x");
  EXPECT_EQ(region.mask, 6u);
  EXPECT_TRUE(region.keep);
  EXPECT_EQ(region.kind, "sphere");
  EXPECT_EQ(region.to, "ship");
  EXPECT_EQ(region.detect, (Names{"enter", "exit"}));
  const ListedStanding bands = client.standing("close")->at(0);
  EXPECT_EQ(bands.form, StandingForm::bands);
  EXPECT_EQ(bands.around, "a");
  EXPECT_EQ(bands.bands_m, (std::vector<double>{5, 2, 0}));
  EXPECT_EQ(bands.hysteresis_m, 0.5);
  EXPECT_EQ(bands.dwell, 200ms);
  EXPECT_FALSE(bands.keep);
  const ListedStanding nearest = client.standing("first")->at(0);
  EXPECT_EQ(nearest.form, StandingForm::nearest);
  EXPECT_EQ(nearest.point, Vec3(1, 2, 3));
  EXPECT_EQ(nearest.within_m, 9);
  EXPECT_EQ(nearest.hysteresis_m, 0.25);
}

TEST_F(ServerStanding, WhatIsWrongIsRefusedWithItsReason) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(escape()));
  const SphereShape ball{.radius_m = 1};
  const double endless = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<Standing, std::string>> wrong{
      {{.name = "no", .only = "", .of = Bands{.around = "a", .bands_m = {1}}}, "two names or globs are needed"},
      {{.name = "no", .only = "b", .of = Bands{.around = "a", .bands_m = {1, 2}}},
       "band 2 is 2 m, which is not less than 1 m before it"},
      {{.name = "no", .only = "b", .of = Bands{.around = "a", .bands_m = {endless}}}, "a band is not finite"},
      {{.name = "no", .only = "b", .of = Bands{.around = "a", .bands_m = {1}, .dwell = -1ns}}, "its dwell is negative"},
      {{.name = "no", .only = "a", .of = Nearest{.within_m = 1}}, "an object, 'to', or a point is needed"},
      {{.name = "no", .only = "", .of = Nearest{.to = "b", .within_m = 1}},
       "the name or glob of the objects is needed"},
      {{.name = "no", .only = "a", .of = Nearest{.to = "b"}}, "it looks 0 m far"},
      {{.name = "no", .only = "a", .of = Nearest{.point = Vec3(0, 0, endless), .within_m = 1}},
       "the point is not finite"},
      {{.name = "no"}, "its shape has no part"},
      {{.name = "\xff", .of = Region{.shape = {ball}}}, "is not UTF-8"},
      {{.name = "escape", .of = Region{.shape = {ball}}}, "the name is taken"},
      {escape(), "the name is taken"},
  };
  for (const auto& [standing, reason] : wrong) {
    const std::string refused = refusal(client, standing);
    EXPECT_NE(refused.find(reason), std::string::npos) << reason << ", but: " << refused;
  }
  EXPECT_EQ(names(client), Names{"escape"});
}

/// A question that the watch hears of while `mover` goes between a place where it holds `held` and one where it does not.
struct Watched {
  Standing standing;
  const char* mover;
  std::string held;
  Vec3 in;
  Vec3 out;
};

class ServerStandingOfEachForm : public ServerStanding, public testing::WithParamInterface<StandingForm> {
 protected:
  static Watched watched() {
    switch (GetParam()) {
      case StandingForm::region: return {dock(), "drone", "drone", {6, 0, 2}, {9, 0, 2}};
      case StandingForm::bands: return {close({5, 2}), "drone", "drone person 5", {4, 0, 2}, {20, 0, 2}};
      case StandingForm::nearest: break;
    }
    return {escape(), "person", "door_a", {0, 0, 2}, {19, 0, 2}};
  }
  /// All the objects; returns the one that moves.
  static Publisher::Object add_all(Publisher& publisher, const Watched& watched) {
    std::optional<Publisher::Object> mover;
    const auto add = [&](const std::string& name, const Pose& pose) {
      const bool is_mover = name == watched.mover;
      const Publisher::Object added = add_ball(publisher, name, is_mover ? Pose{.position = watched.in} : pose);
      if (is_mover) mover = added;
    };
    add("person", at(0, 0, 2));
    add("drone", at(40, 0, 2));
    add("door_a", at(0, 3, 2));
    add("door_b", at(20, 3, 2));
    EXPECT_TRUE(publisher.flush());
    return *mover;
  }
};

TEST_P(ServerStandingOfEachForm, GoesWithItsClientUnlessItIsKept) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(kept(named("stays", watched().standing))));
  {
    Client other = connect();
    ASSERT_TRUE(other.add(named("goes", watched().standing)));
    EXPECT_EQ(names(client), (Names{"goes", "stays"}));
  }
  EXPECT_TRUE(test::eventually([&] { return names(client) == Names{"stays"}; }, 15s));
}

// A server that is killed loses none that was kept, and a watch that goes on reports nothing twice.
TEST_P(ServerStandingOfEachForm, SurvivesAKillAndReportsNothingTwice) {
  start();
  Client client = connect();
  const Watched question = watched();
  ASSERT_TRUE(client.add(kept(question.standing)));
  Publisher publisher = publish(client, "pilot");
  const Publisher::Object mover = add_all(publisher, question);
  ASSERT_TRUE(test::eventually([&] { return held(client, "") == Names{question.held}; }, 15s));
  StandingWatch watch = watch_standing(client);
  const StandingEvent first = next(watch);
  EXPECT_TRUE(first.kind == StandingEventKind::inside || first.kind == StandingEventKind::within ||
              first.kind == StandingEventKind::is);
  servers_.back()->signal(SIGKILL);
  servers_.back()->wait(5s);
  start({}, "server 1");
  Client again = connect();
  ASSERT_TRUE(test::eventually(
      [&] {
        move(publisher, mover, {.position = question.in + Vec3(0.1, 0, 0)});
        return held(again, "") == Names{question.held};
      },
      15s));
  EXPECT_TRUE(test::eventually([&] { return watch.connected() && watch.in_step(); }, 15s));
  // What it holds, as the events have it. Its publisher defines all anew, which may end and begin it.
  std::string holds = first.object;
  const bool is_nearest = question.standing.form() == StandingForm::nearest;
  EXPECT_TRUE(test::eventually(
      [&] {
        move(publisher, mover, {.position = question.out});
        while (const std::optional<StandingEvent> event = watch.next(20ms)) {
          const bool is_end = event->kind == StandingEventKind::exit || event->kind == StandingEventKind::leave;
          const std::string now = is_end ? "" : event->object;
          const bool is_anew = event->reason == EndReason::geometry_changed;
          EXPECT_TRUE(is_anew || now != holds) << "reported twice, with sequence number " << event->sequence;
          holds = now;
        }
        return holds == (is_nearest ? "door_b" : "");
      },
      15s));
}

INSTANTIATE_TEST_SUITE_P(Forms, ServerStandingOfEachForm,
                         testing::Values(StandingForm::region, StandingForm::bands, StandingForm::nearest),
                         [](const auto& form) { return std::string(name_of(form.param)); });

}  // namespace
}  // namespace collided
