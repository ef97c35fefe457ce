// Bands over the wire: which pairs come within which distance, and what comes next.
#include <thread>

#include "tests/service/standing_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ServerBands : public testing_support::StandingTest {
 protected:
  static void expect(const StandingEvent& event, StandingEventKind kind, double band_m) {
    StandingTest::expect(event, kind, "drone", "person", band_m);
    EXPECT_EQ(event.form, StandingForm::bands);
  }
};

TEST_F(ServerBands, EveryBandIsReportedWithHowItGoesOn) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(close({5, 2})));
  StandingWatch watch = watch_standing(client);
  StandingWatch regions = watch_standing(client, {.form = StandingForm::region});
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "person", at(0, 0, 2));
  const Publisher::Object drone = add_ball(publisher, "drone", at(20, 0, 2));
  move(publisher, drone, at(20, 0, 2));
  std::this_thread::sleep_for(200ms);  // how long it flies
  move(publisher, drone, at(3, 0, 2));
  const StandingEvent approach = next(watch);
  expect(approach, StandingEventKind::approach, 5);
  EXPECT_EQ(approach.standing, "close");
  EXPECT_NEAR(approach.distance_m, 5, 1e-3);
  EXPECT_GT(approach.closing_mps, 0);
  EXPECT_GE(approach.bracket_low_s, approach.bracket_high_s);
  ASSERT_TRUE(approach.contact_in);
  // At even speed.
  EXPECT_NEAR(approach.contact_in->high_s, approach.distance_m / approach.closing_mps, 1e-3);
  move(publisher, drone, at(0.1, 0, 2));
  expect(next(watch), StandingEventKind::near, 2);
  expect(next(watch), StandingEventKind::contact, 0);
  EXPECT_EQ(held(client, "close"), Names{"drone person 0"});
  move(publisher, drone, at(20, 0, 2));
  for (const double band_m : {5.0, 2.0, 0.0}) {
    const StandingEvent left = next(watch);
    expect(left, StandingEventKind::leave, band_m);
    EXPECT_EQ(left.reason, EndReason::separated);
  }
  EXPECT_FALSE(watch.next(200ms));
  EXPECT_FALSE(regions.next(0ms)) << "they are no news of a region";
  EXPECT_EQ(watch.resyncs(), 0u);
  EXPECT_EQ(watch.lost(), 0u);
}

// A monitor that looks at the newest state when it has time loses those that were replaced meanwhile.
TEST_F(ServerBands, EveryPoseCountsHoweverFastTheyCome) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(close({5})));
  StandingWatch watch = watch_standing(client);
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "person", at(0, 0, 2));
  const Publisher::Object drone = add_ball(publisher, "drone", at(20, 0, 2));
  ASSERT_TRUE(publisher.flush());
  constexpr int kPasses = 20;
  for (int i = 0; i < kPasses; ++i) {
    move(publisher, drone, at(3, 0, 2));
    move(publisher, drone, at(20, 0, 2));
  }
  for (int i = 0; i < kPasses; ++i) {
    expect(next(watch), StandingEventKind::approach, 5);
    expect(next(watch), StandingEventKind::leave, 5);
  }
  EXPECT_FALSE(watch.next(200ms));
  EXPECT_EQ(watch.lost(), 0u);
}

TEST_F(ServerBands, ALaterWatchBeginsWithWhatIsNear) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "person", at(0, 0, 2));
  add_ball(publisher, "drone", at(4, 0, 2));
  ASSERT_TRUE(client.add(close({5, 1})));
  ASSERT_TRUE(test::eventually([&] { return held(client, "close") == Names{"drone person 5"}; }));
  StandingWatch watch = watch_standing(client, {.only = "dro*"});
  expect(next(watch), StandingEventKind::within, 5);
  StandingWatch other = watch_standing(client, {.only = "robot*"});
  EXPECT_FALSE(other.next(100ms));
  EXPECT_EQ(*client.remove_standing("cl*"), 1u);
  const StandingEvent left = next(watch);
  expect(left, StandingEventKind::leave, 5);
  EXPECT_EQ(left.reason, EndReason::fence_removed);
  EXPECT_EQ(names(client), Names());
}

// Nothing moves any more, and yet the dwell ends: as far as its publisher says that time has gone on.
TEST_F(ServerBands, ADwellEndsWithThePublishersTime) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(close({5}, 200ms)));
  StandingWatch watch = watch_standing(client);
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "person", at(0, 0, 2));
  const Publisher::Object drone = add_ball(publisher, "drone", at(20, 0, 2));
  // With times of its own, a publisher that lives says nothing of time between its flushes.
  const std::chrono::nanoseconds came_in = std::chrono::system_clock::now().time_since_epoch();
  ASSERT_TRUE(publisher.move(drone, at(4, 0, 2)));
  ASSERT_TRUE(publisher.flush(came_in));
  for (int wait = 0; wait < 4; ++wait) {
    EXPECT_FALSE(watch.next(100ms)) << "nobody knows whether it is there still";
    EXPECT_TRUE(publisher.keep_alive());
  }
  EXPECT_TRUE(publisher.flush(came_in + 100ms));
  EXPECT_FALSE(watch.next(100ms)) << "it has been there for half of the dwell";
  EXPECT_TRUE(publisher.flush(came_in + 300ms));
  const StandingEvent came = next(watch);
  expect(came, StandingEventKind::approach, 5);
  EXPECT_GE(came.bracket_high_s, 0.2) << "reported that long after it happened";
}

// What commands move is known up to now.
TEST_F(ServerBands, ADwellEndsThoughNoMessageComes) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(close({5}, 300ms)));
  StandingWatch watch = watch_standing(client);
  ASSERT_TRUE(client.add({.name = "person", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(0, 0, 2)}));
  ASSERT_TRUE(client.add({.name = "drone", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(4, 0, 2)}));
  const StandingEvent came = next(watch);
  expect(came, StandingEventKind::approach, 5);
  EXPECT_GE(came.bracket_high_s, 0.3);
}

// The small warehouse, which is loaded, has parts and nothing else that bands could be around.
TEST_F(ServerBands, PartsOfScenesHaveNoBandsAndAddingOneSaysSo) {
  start();
  Client client = connect();
  const Result<AddedStanding> silent =
      client.add(Standing{.name = "silent", .only = "drone*", .of = Bands{.around = "warehouse/*", .bands_m = {5}}});
  ASSERT_TRUE(silent) << silent.error().message;
  EXPECT_GT(silent->parts, 10u);
  const Result<AddedStanding> loud = client.add(close({5}));
  ASSERT_TRUE(loud) << loud.error().message;
  EXPECT_EQ(loud->parts, 0u);
}

// The drone's owner dies: that ends what the drone was near to, with the reason.
TEST_F(ServerBands, TheEndOfAPublisherEndsItsStays) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add(close({5})));
  StandingWatch watch = watch_standing(client);
  Publisher people = publish(client, "people");
  add_ball(people, "person", at(0, 0, 2));
  {
    Client other = connect();
    Publisher pilots = publish(other, "pilots");
    add_ball(pilots, "drone", at(4, 0, 2));
    expect(next(watch), StandingEventKind::approach, 5);
  }
  const StandingEvent left = next(watch, 10s);
  expect(left, StandingEventKind::leave, 5);
  EXPECT_TRUE(left.reason == EndReason::publisher_lost || left.reason == EndReason::removed);
}

}  // namespace
}  // namespace collided
