// Regions over the wire: which objects come in and go out.
#include "tests/service/standing_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ServerRegions : public testing_support::StandingTest {
 protected:
  static void expect(const StandingEvent& event, StandingEventKind kind, const std::string& object,
                     const std::string& region) {
    StandingTest::expect(event, kind, object, "");
    EXPECT_EQ(event.standing, region);
    EXPECT_EQ(event.form, StandingForm::region);
  }
};

TEST_F(ServerRegions, ComingInAndGoingOutIsReported) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(dock()));
  StandingWatch watch = watch_standing(client);
  Publisher publisher = publish(client, "pilot");
  const Publisher::Object drone = add_ball(publisher, "drone", at(0, 0, 2));
  move(publisher, drone, at(6, 0, 2));
  const StandingEvent came = next(watch);
  expect(came, StandingEventKind::enter, "drone", "dock");
  EXPECT_NEAR(came.point.x(), 5, 1e-6);
  EXPECT_GE(came.bracket_low_s, came.bracket_high_s);
  // In, across a wall that no sample touches, and out of all.
  ASSERT_TRUE(client.add(box("wire", {8, -1, 1}, {8.01, 1, 3})));
  EXPECT_EQ(held(client, "dock"), Names{"drone"});
  move(publisher, drone, at(12, 0, 2));
  const StandingEvent left = next(watch);
  expect(left, StandingEventKind::exit, "drone", "dock");
  EXPECT_EQ(left.reason, EndReason::separated);
  EXPECT_EQ(left.episode, came.sequence);
  const StandingEvent crossed = next(watch);
  expect(crossed, StandingEventKind::cross, "drone", "wire");
  EXPECT_GT(crossed.bracket_low_s, crossed.left_high_s);
  EXPECT_EQ(watch.resyncs(), 0u);
  EXPECT_EQ(watch.lost(), 0u);
}

TEST_F(ServerRegions, ALaterWatchBeginsWithWhatIsIn) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "drone", at(6, 0, 2));
  ASSERT_TRUE(client.add(dock()));
  ASSERT_TRUE(test::eventually([&] { return held(client, "dock") == Names{"drone"}; }));
  StandingWatch watch = watch_standing(client);
  expect(next(watch), StandingEventKind::inside, "drone", "dock");
  EXPECT_EQ(*client.remove_standing("do*"), 1u);
  const StandingEvent left = next(watch);
  expect(left, StandingEventKind::exit, "drone", "dock");
  EXPECT_EQ(left.reason, EndReason::fence_removed);
  EXPECT_EQ(names(client), Names());
}

TEST_F(ServerRegions, ARegionReportsWhatItIsAskedTo) {
  start();
  Client client = connect();
  Standing exits = named("exits", dock());
  std::get<Region>(exits.of).enter = std::get<Region>(exits.of).cross = false;
  Standing passages = named("passages", dock());
  std::get<Region>(passages.of).enter = std::get<Region>(passages.of).exit = false;
  ASSERT_TRUE(client.add(exits));
  ASSERT_TRUE(client.add(passages));
  StandingWatch watch = watch_standing(client);
  Publisher publisher = publish(client, "pilot");
  const Publisher::Object drone = add_ball(publisher, "drone", at(0, 0, 2));
  move(publisher, drone, at(6, 0, 2));
  move(publisher, drone, at(9, 0, 2));
  expect(next(watch), StandingEventKind::exit, "drone", "exits");
  // A passage, which the one reports as such and the other as its going out.
  move(publisher, drone, at(0, 0, 2));
  expect(next(watch), StandingEventKind::exit, "drone", "exits");
  expect(next(watch), StandingEventKind::cross, "drone", "passages");
  EXPECT_FALSE(watch.next(200ms));
}

TEST_F(ServerRegions, ARegionGoesWithItsCarrier) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(Standing{
      .name = "around", .only = "robot*", .of = Region{.shape = {SphereShape{.radius_m = 1}}, .to = "person"}}));
  StandingWatch watch = watch_standing(client);
  Publisher people = publish(client, "people");
  Publisher robots = publish(client, "robots");
  const Publisher::Object person = add_ball(people, "person", at(0, 0, 2));
  const Publisher::Object robot = add_ball(robots, "robot", at(5, 0, 2));
  move(people, person, at(0, 0, 2));
  move(robots, robot, at(5, 0, 2));
  // Decided as soon as both have said where they are at one time.
  std::optional<StandingEvent> came;
  EXPECT_TRUE(test::eventually([&] {
    move(people, person, at(4.5, 0, 2));
    move(robots, robot, at(5, 0, 2));
    return (came = watch.next(20ms)).has_value();
  }));
  ASSERT_TRUE(came);
  expect(*came, StandingEventKind::enter, "robot", "around");
}

TEST_F(ServerRegions, APrismNeedNotBeConvex) {
  start();
  Client client = connect();
  // An L: the drone is in its notch first.
  const Prism prism{.corners = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}}, .low_m = 1, .high_m = 3};
  ASSERT_TRUE(client.add(Standing{.name = "yard", .of = Region{.prism = prism}}));
  StandingWatch watch = watch_standing(client);
  Publisher publisher = publish(client, "pilot");
  const Publisher::Object drone = add_ball(publisher, "drone", at(3, 3, 2));
  move(publisher, drone, at(3, 3, 2.1));
  EXPECT_FALSE(watch.next(200ms));
  move(publisher, drone, at(0.5, 3, 2));
  expect(next(watch), StandingEventKind::enter, "drone", "yard");
  move(publisher, drone, at(0.5, 0.5, 2));
  EXPECT_FALSE(watch.next(200ms));
}

TEST_F(ServerRegions, ManyComeInFewMessages) {
  start();
  Client client = connect();
  std::vector<Standing> fences;
  constexpr int kCount = 20'000;  // more than a message holds
  for (int i = 0; i < kCount; ++i) {
    const Vec3 low(i % 200, i / 200, 5);
    fences.push_back(box("cell_" + std::to_string(i), low, low + Vec3(0.9, 0.9, 0.9)));
  }
  const auto began = std::chrono::steady_clock::now();
  const Result<void> added = client.add(fences);
  ASSERT_TRUE(added) << added.error().message;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  std::printf("fences=%d seconds=%.3f\n", kCount, took.count());
  for (const char* name : {"cell_0", "cell_6999", "cell_19999"}) EXPECT_EQ(names(client, name), Names{name});
  // One that is refused says which, and no other of its message is added: a recording knows it as refused.
  const std::vector<Standing> twice{box("new", {0, 0, 0}, {1, 1, 1}), fences[7]};
  const Result<void> refused = client.add(twice);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("fence 2 of 2"), std::string::npos) << refused.error().message;
  EXPECT_EQ(names(client, "new"), Names());
  EXPECT_TRUE(client.add(twice[0])) << "its name is free";
}

TEST_F(ServerRegions, WhatHoldsNothingIsRefused) {
  start();
  Client client = connect();
  const MeshShape sheet{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}};
  const Result<AddedStanding> surface = client.add(Standing{.name = "sheet", .of = Region{.shape = {sheet}}});
  ASSERT_FALSE(surface);
  EXPECT_NE(surface.error().message.find("holds nothing"), std::string::npos) << surface.error().message;
  const Prism bow{.corners = {{0, 0}, {1, 1}, {1, 0}, {0, 1}}, .low_m = 0, .high_m = 1};
  const Result<AddedStanding> crossing = client.add(Standing{.name = "bow", .of = Region{.prism = bow}});
  ASSERT_FALSE(crossing);
  EXPECT_NE(crossing.error().message.find("crosses"), std::string::npos) << crossing.error().message;
  EXPECT_EQ(names(client), Names());
}

}  // namespace
}  // namespace collided
