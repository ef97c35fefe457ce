// Questions for the nearest over the wire: which object follows which.
#include <thread>

#include "tests/service/standing_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ServerNearest : public testing_support::StandingTest {
 protected:
  static void expect(const StandingEvent& event, const std::string& from, const std::string& to) {
    StandingTest::expect(event, StandingEventKind::changed, to, from);
  }
};

TEST_F(ServerNearest, AChangeSaysFromWhichToWhichAndHowFar) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(escape()));
  StandingWatch watch = watch_standing(client);
  StandingWatch regions = watch_standing(client, {.form = StandingForm::region});
  StandingWatch bands = watch_standing(client, {.form = StandingForm::bands});
  Publisher publisher = publish(client, "guide");
  add_ball(publisher, "door_a", at(0, 3, 2));
  add_ball(publisher, "door_b", at(20, 3, 2));
  const Publisher::Object person = add_ball(publisher, "person", at(1, 0, 2));
  const std::chrono::nanoseconds first = std::chrono::system_clock::now().time_since_epoch();
  ASSERT_TRUE(publisher.flush(first));
  StandingEvent event = next(watch);
  expect(event, "", "door_a");
  EXPECT_EQ(event.standing, "escape");
  std::this_thread::sleep_for(500ms);  // as long as the times that it gives
  ASSERT_TRUE(publisher.flush(first + 100ms));
  ASSERT_TRUE(publisher.move(person, at(19, 0, 2)));
  ASSERT_TRUE(publisher.flush(first + 300ms));
  event = next(watch);
  expect(event, "door_a", "door_b");
  EXPECT_EQ(event.reason, EndReason::separated);
  // Halfway.
  const auto told_at = [&](double before_s) {
    return std::chrono::duration<double>(event.world_time - first).count() - before_s;
  };
  EXPECT_LE(told_at(event.bracket_low_s), 0.2 + 1e-9);
  EXPECT_GE(told_at(event.bracket_high_s), 0.2 - 1e-9);
  EXPECT_NEAR(told_at(event.bracket_high_s), 0.2, 1e-6);
  EXPECT_EQ(held(client, "escape"), Names{"door_b"});
  ASSERT_TRUE(publisher.move(person, at(300, 0, 2)));
  ASSERT_TRUE(publisher.flush(first + 500ms));
  event = next(watch);
  expect(event, "door_b", "");
  EXPECT_EQ(held(client, "escape"), Names());
  EXPECT_EQ(watch.lost(), 0u);
  EXPECT_FALSE(regions.next(50ms)) << "it is no news of a region";
  EXPECT_FALSE(bands.next(50ms));
}

TEST_F(ServerNearest, APassageBetweenTwoPosesIsTwoChanges) {
  start();
  Client client = connect();
  ASSERT_TRUE(
      client.add(Standing{.name = "first", .only = "drone*", .of = Nearest{.point = Vec3(0, 0, 2), .within_m = 50}}));
  StandingWatch watch = watch_standing(client);
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "drone_waits", at(0, 6, 2));
  const Publisher::Object flies = add_ball(publisher, "drone_flies", at(-40, 1, 2));
  ASSERT_TRUE(publisher.flush());
  expect(next(watch), "", "drone_waits");
  move(publisher, flies, at(40, 1, 2));
  expect(next(watch), "drone_waits", "drone_flies");
  expect(next(watch), "drone_flies", "drone_waits");
}

TEST_F(ServerNearest, ALaterWatchBeginsWithWhatIsNearestAndWhyThatEnds) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "guide");
  const Publisher::Object door = add_ball(publisher, "door_a", at(0, 3, 2));
  add_ball(publisher, "door_b", at(0, 9, 2));
  add_ball(publisher, "person", at(0, 0, 2));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(client.add(escape()));
  ASSERT_TRUE(test::eventually([&] { return held(client, "escape") == Names{"door_a"}; }));
  StandingWatch watch = watch_standing(client, {.only = "esc*"});
  const StandingEvent is = next(watch);
  EXPECT_EQ(is.kind, StandingEventKind::is);
  EXPECT_EQ(is.object, "door_a");
  EXPECT_NEAR(is.distance_m, 3 - 0.2, 1e-6);
  ASSERT_TRUE(publisher.remove(door));
  ASSERT_TRUE(publisher.flush());
  const StandingEvent next_door = next(watch);
  expect(next_door, "door_a", "door_b");
  EXPECT_EQ(next_door.reason, EndReason::removed);
  EXPECT_EQ(*client.remove_standing("esc*"), 1u);
  const StandingEvent gone = next(watch);
  expect(gone, "door_b", "");
  EXPECT_EQ(gone.reason, EndReason::fence_removed);
  EXPECT_EQ(names(client), Names());
}

// Nothing moves, and no publisher is alive: what commands put there is known up to now.
TEST_F(ServerNearest, WhatCommandsPutThereCounts) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(escape()));
  StandingWatch watch = watch_standing(client);
  ASSERT_TRUE(client.add({.name = "person", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(0, 0, 2)}));
  ASSERT_TRUE(client.add({.name = "door_a", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(4, 0, 2)}));
  expect(next(watch), "", "door_a");
  ASSERT_TRUE(client.add({.name = "door_b", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(3, 0, 2)}));
  expect(next(watch), "door_a", "door_b");
}

}  // namespace
}  // namespace collided
