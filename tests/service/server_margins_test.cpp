// Margins over the wire: who comes within which band, what comes next, kept ones after a kill, owned ones after theirs.
#include <csignal>
#include <thread>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using Names = std::vector<std::string>;

class ServerMargins : public testing_support::ServerTest {
 protected:
  static MarginWatch watch_margins(Client& client, const MarginWatchOptions& options = {}) {
    Result<MarginWatch> watch = client.watch_margins(options);
    EXPECT_TRUE(watch) << watch.error().message;
    EXPECT_TRUE(test::eventually([&] { return watch->in_step(); }));
    return std::move(*watch);
  }
  static MarginEvent next(MarginWatch& watch, std::chrono::milliseconds wait = 5s) {
    const std::optional<MarginEvent> event = watch.next(wait);
    EXPECT_TRUE(event) << "no event in time";
    return event.value_or(MarginEvent{});
  }
  static Margin margin(const std::string& name, std::vector<double> bands_m, bool keep = false) {
    return {.name = name, .around = "person*", .only = "drone*", .bands_m = std::move(bands_m), .keep = keep};
  }
  static Names margin_names(Client& client) {
    Names names;
    const Result<std::vector<ListedMargin>> margins = client.margins();
    if (!margins) return {margins.error().message};
    for (const ListedMargin& listed : *margins) names.push_back(listed.margin.name);
    return names;
  }
  static Names pairs(Client& client, const std::string& name) {
    Names all;
    const Result<std::vector<ListedMargin>> margins = client.margins(name);
    if (!margins) return {margins.error().message};
    for (const ListedMargin& listed : *margins) {
      for (const MarginPair& pair : listed.pairs)
        all.push_back(pair.object + " " + pair.around + " " + std::to_string(pair.within_m).substr(0, 3));
    }
    return all;
  }
  static void expect(const MarginEvent& event, MarginEventKind kind, double band_m) {
    EXPECT_EQ(event.kind, kind);
    EXPECT_EQ(event.band_m, band_m);
    EXPECT_EQ(event.object, "drone");
    EXPECT_EQ(event.around, "person");
  }
};

TEST_F(ServerMargins, EveryBandIsToldWithHowItGoesOn) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_margin(margin("close", {5, 2})));
  MarginWatch watch = watch_margins(client);
  Result<FenceWatch> fences = client.watch_fences();
  ASSERT_TRUE(fences);
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "person", at(0, 0, 2));
  const Publisher::Object drone = add_ball(publisher, "drone", at(20, 0, 2));
  move(publisher, drone, at(20, 0, 2));
  std::this_thread::sleep_for(200ms);  // how long it flies
  move(publisher, drone, at(3, 0, 2));
  const MarginEvent approach = next(watch);
  expect(approach, MarginEventKind::approach, 5);
  EXPECT_EQ(approach.margin, "close");
  EXPECT_NEAR(approach.distance_m, 5, 1e-3);
  EXPECT_GT(approach.closing_mps, 0);
  EXPECT_GE(approach.bracket_low_s, approach.bracket_high_s);
  ASSERT_TRUE(approach.contact_in);
  // At even speed.
  EXPECT_NEAR(approach.contact_in->high_s, approach.distance_m / approach.closing_mps, 1e-3);
  move(publisher, drone, at(0.1, 0, 2));
  expect(next(watch), MarginEventKind::near, 2);
  expect(next(watch), MarginEventKind::contact, 0);
  EXPECT_EQ(pairs(client, "close"), Names{"drone person 0.0"});
  move(publisher, drone, at(20, 0, 2));
  for (const double band_m : {5.0, 2.0, 0.0}) {
    const MarginEvent left = next(watch);
    expect(left, MarginEventKind::leave, band_m);
    EXPECT_EQ(left.reason, EndReason::separated);
  }
  EXPECT_FALSE(watch.next(200ms));
  EXPECT_FALSE(fences->next(0ms)) << "a fence's watch knows of no margin";
  EXPECT_EQ(watch.resyncs(), 0u);
  EXPECT_EQ(watch.lost(), 0u);
}

// A monitor that looks at the newest state when it has time loses those that were replaced meanwhile.
TEST_F(ServerMargins, EveryPoseCountsHoweverFastTheyCome) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_margin(margin("close", {5})));
  MarginWatch watch = watch_margins(client);
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
    expect(next(watch), MarginEventKind::approach, 5);
    expect(next(watch), MarginEventKind::leave, 5);
  }
  EXPECT_FALSE(watch.next(200ms));
  EXPECT_EQ(watch.lost(), 0u);
}

TEST_F(ServerMargins, WhoBeginsToWatchLaterIsToldWhoIsNear) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "person", at(0, 0, 2));
  add_ball(publisher, "drone", at(4, 0, 2));
  ASSERT_TRUE(client.add_margin(margin("close", {5, 1})));
  ASSERT_TRUE(test::eventually([&] { return pairs(client, "close") == Names{"drone person 5.0"}; }));
  MarginWatch watch = watch_margins(client, {.only = "dro*"});
  expect(next(watch), MarginEventKind::within, 5);
  MarginWatch other = watch_margins(client, {.only = "robot*"});
  EXPECT_FALSE(other.next(100ms));
  EXPECT_EQ(*client.remove_margins("cl*"), 1u);
  const MarginEvent left = next(watch);
  expect(left, MarginEventKind::leave, 5);
  EXPECT_EQ(left.reason, EndReason::fence_removed);
  EXPECT_EQ(margin_names(client), Names());
}

// Nothing moves any more, and yet the dwell ends: as far as its publisher says that time has gone on.
TEST_F(ServerMargins, ADwellEndsWithThePublishersTime) {
  start();
  Client client = connect();
  Margin close = margin("close", {5});
  close.dwell = 200ms;
  ASSERT_TRUE(client.add_margin(close));
  MarginWatch watch = watch_margins(client);
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
  const MarginEvent came = next(watch);
  expect(came, MarginEventKind::approach, 5);
  EXPECT_GE(came.bracket_high_s, 0.2) << "told that long after it happened";
}

// What commands move is known up to now.
TEST_F(ServerMargins, ADwellEndsThoughNobodySaysAnything) {
  start();
  Client client = connect();
  Margin close = margin("close", {5});
  close.dwell = 300ms;
  ASSERT_TRUE(client.add_margin(close));
  MarginWatch watch = watch_margins(client);
  ASSERT_TRUE(client.add({.name = "person", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(0, 0, 2)}));
  ASSERT_TRUE(client.add({.name = "drone", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(4, 0, 2)}));
  const MarginEvent came = next(watch);
  expect(came, MarginEventKind::approach, 5);
  EXPECT_GE(came.bracket_high_s, 0.3);
}

TEST_F(ServerMargins, FencesAndMarginsAreListedAndRemovedApart) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_margin(margin("close", {5})));
  ASSERT_TRUE(client.add_fence({.name = "dock", .shape = {SphereShape{.radius_m = 1}}}));
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "person", at(0, 0, 5));
  EXPECT_EQ(client.fences()->size(), 1u);
  EXPECT_EQ(client.margins()->size(), 1u);
  EXPECT_EQ(*client.remove_fences("*"), 1u);
  EXPECT_EQ(margin_names(client), Names{"close"});
  EXPECT_EQ(*client.remove_margins("*"), 1u);
  const Result<AddedMargin> taken = client.add_margin({.name = "no", .around = "a", .only = "", .bands_m = {1}});
  ASSERT_FALSE(taken);
  EXPECT_NE(taken.error().message.find("two names or globs are needed"), std::string::npos) << taken.error().message;
  const Result<AddedMargin> wrong = client.add_margin({.name = "no", .around = "a", .only = "b", .bands_m = {1, 2}});
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("band 2 is 2 m, which is not less than 1 m before it"), std::string::npos)
      << wrong.error().message;
  EXPECT_EQ(margin_names(client), Names());
}

// The small warehouse, which is loaded, has parts and nothing else that a margin could be about.
TEST_F(ServerMargins, PartsOfScenesHaveNoBandsAndAddingOneSaysSo) {
  start();
  Client client = connect();
  const Result<AddedMargin> silent =
      client.add_margin({.name = "silent", .around = "warehouse/*", .only = "drone*", .bands_m = {5}});
  ASSERT_TRUE(silent) << silent.error().message;
  EXPECT_GT(silent->parts, 10u);
  const Result<AddedMargin> close = client.add_margin(margin("close", {5}));
  ASSERT_TRUE(close) << close.error().message;
  EXPECT_EQ(close->parts, 0u);
}

TEST_F(ServerMargins, OneThatIsNotKeptGoesWithItsClient) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_margin(margin("stays", {5}, true)));
  {
    Client other = connect();
    ASSERT_TRUE(other.add_margin(margin("goes", {5})));
    EXPECT_EQ(margin_names(client), (Names{"goes", "stays"}));
  }
  EXPECT_TRUE(test::eventually([&] { return margin_names(client) == Names{"stays"}; }, 15s));
}

TEST_F(ServerMargins, AKillLosesNoKeptMarginAndTellsNothingTwice) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_margin(margin("close", {5, 2}, true)));
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "person", at(0, 0, 2));
  const Publisher::Object drone = add_ball(publisher, "drone", at(4, 0, 2));
  ASSERT_TRUE(test::eventually([&] { return pairs(client, "close") == Names{"drone person 5.0"}; }));
  MarginWatch watch = watch_margins(client);
  expect(next(watch), MarginEventKind::within, 5);
  servers_.back()->signal(SIGKILL);
  servers_.back()->wait(5s);
  start({}, "server 1");
  Client again = connect();
  ASSERT_TRUE(test::eventually(
      [&] {
        move(publisher, drone, at(4.1, 0, 2));
        return pairs(again, "close") == Names{"drone person 5.0"};
      },
      15s));
  EXPECT_TRUE(test::eventually([&] { return watch.connected() && watch.in_step(); }, 15s));
  bool is_in = true;
  EXPECT_TRUE(test::eventually(
      [&] {
        move(publisher, drone, at(20, 0, 2));
        while (const std::optional<MarginEvent> event = watch.next(20ms)) {
          const bool came = event->kind == MarginEventKind::approach;
          EXPECT_EQ(event->band_m, 5);
          EXPECT_NE(came, is_in) << "told twice, with sequence number " << event->sequence;
          is_in = came;
        }
        return !is_in;
      },
      15s));
}

// The owner of the drone dies: what it was near to hears of it, with the reason.
TEST_F(ServerMargins, TheEndOfAPublisherEndsItsStays) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_margin(margin("close", {5})));
  MarginWatch watch = watch_margins(client);
  Publisher people = publish(client, "people");
  add_ball(people, "person", at(0, 0, 2));
  {
    Client other = connect();
    Publisher pilots = publish(other, "pilots");
    add_ball(pilots, "drone", at(4, 0, 2));
    expect(next(watch), MarginEventKind::approach, 5);
  }
  const MarginEvent left = next(watch, 10s);
  expect(left, MarginEventKind::leave, 5);
  EXPECT_TRUE(left.reason == EndReason::publisher_lost || left.reason == EndReason::removed);
}

}  // namespace
}  // namespace collided
