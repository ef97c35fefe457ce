// What a watch of the shards does when servers stop or it ends itself. map_in_etcd_test.cpp has standbys, border_crossings.cpp
// what a watch reports of objects that cross borders.
#include <atomic>
#include <chrono>
#include <csignal>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "collided/shards.hpp"
#include "idl/dds.hpp"
#include "tests/service/eventually.hpp"
#include "tests/shards/sharded_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ShardedWatching : public testing_support::ShardedWorldTest {
 protected:
  /// Starts the two halves of a world, split at x = 0, and returns the eastern one.
  testing_support::ChildProcess& start_halves() {
    write_map(R"({"margin_m": 2, "shards": [
        {"name": "west", "low": [null, null, null], "high": [0, null, null]},
        {"name": "east", "low": [0, null, null], "high": [null, null, null]}]})");
    start_shard("west");
    return start_shard("east");
  }
};

// What happened between the two lives of a server is missing.
TEST_F(ShardedWatching, AServerThatIsStartedAgainIsAGap) {
  testing_support::ChildProcess& east = start_halves();
  ShardedClient client = connect_sharded();
  Result<ShardedWatch> watch = client.watch();
  ASSERT_TRUE(watch) << watch.error().message;
  ASSERT_TRUE(test::eventually([&] { return watch->settled() > 0s; }));
  EXPECT_EQ(watch->gaps(), 0U);
  east.signal(SIGKILL);
  east.wait(5s);
  start_shard("east");
  EXPECT_TRUE(test::eventually([&] { return watch->gaps() > 0; }, 20s));
}

/// How much comes to a shard within two seconds: questions, greetings and commands.
int queries_to(const std::string& shard, int domain) {
  const dds::Participant participant({.domain = domain, .role = dds::Role::server, .process_domain = domain + 100'000});
  const dds::Topic<wire::Query> topic(participant, "collided/shard_" + shard);
  std::atomic<int> count{0};
  const dds::Reader<wire::Query> reader(topic, {.data = [&](dds::Taker<wire::Query> taker) {
                                          for (dds::Sample<wire::Query> query; taker.take(query);) ++count;
                                        }});
  EXPECT_TRUE(test::eventually([&] { return reader.matched_writers() > 0; }));
  count = 0;
  std::this_thread::sleep_for(2s);
  return count;
}

// One of the shards is asked once a second whether one is split. All else comes with the servers' own messages.
TEST_F(ShardedWatching, AnIdleWatchAsksNothing) {
  start_halves();
  ShardedClient client = connect_sharded();
  Result<ShardedWatch> watch = client.watch();
  ASSERT_TRUE(watch) << watch.error().message;
  ASSERT_TRUE(test::eventually([&] { return watch->settled() > 0s; }));
  const auto before = watch->settled();
  EXPECT_LE(queries_to("west", domain_), 3);
  EXPECT_GT(watch->settled() - before, 1s) << "what is decided goes on";
}

// Both shards hold the two balls, far above the scene, and only one of the shards is started again.
TEST_F(ShardedWatching, AContactThatAnotherShardHoldsOutlivesARestart) {
  testing_support::ChildProcess& east = start_halves();
  ShardedClient client = connect_sharded();
  Result<ShardedWatch> watch = client.watch();
  ASSERT_TRUE(watch) << watch.error().message;
  ASSERT_TRUE(test::eventually([&] { return watch->settled() > 0s; }));
  Result<ShardedPublisher> publisher = client.publish("balls", {.lease = 60s});
  ASSERT_TRUE(publisher) << publisher.error().message;
  const Shape ball{SphereShape{.radius_m = 0.2}};
  const auto left = publisher->add({.name = "left", .shape = ball, .pose = {.position = {0.4, 0, 50}}});
  ASSERT_TRUE(left && publisher->add({.name = "right", .shape = ball, .pose = {.position = {0.6, 0, 50}}}));
  std::vector<EventKind> kinds;
  const auto flush_until = [&](const auto& is_done) {
    const auto look = [&] {
      EXPECT_TRUE(publisher->flush());
      while (const std::optional<Event> event = watch->next(0s)) kinds.push_back(event->kind);
      return is_done();
    };
    return test::eventually(look, 20s);
  };
  ASSERT_TRUE(flush_until([&] { return !kinds.empty(); }));
  ASSERT_TRUE(flush_until([&] { return publisher->copies() == 4; }));
  east.signal(SIGTERM);
  east.wait(5s);
  start_shard("east");
  ASSERT_TRUE(flush_until([&] { return watch->gaps() > 0; }));
  Client eastern = connect_to_shard("east");
  ASSERT_TRUE(flush_until([&] {
    const Result<ServerStatus> status = eastern.status();
    return status && status->contacts == 1;
  }));
  // It ends when the two part, and not before.
  ASSERT_TRUE(publisher->move(*left, {.position = {-1, 0, 50}}));
  ASSERT_TRUE(flush_until([&] { return kinds.size() > 1; }));
  EXPECT_EQ(kinds, (std::vector{EventKind::began, EventKind::ended}));
  ASSERT_TRUE(flush_until([&] { return watch->open_contacts() == 0; }));
}

// The threads of the shards' watches go on calling back until each of them is destroyed.
TEST_F(ShardedWatching, CanBeDestroyedWhileEventsCome) {
  constexpr int kPairs = 150;
  constexpr int kWatches = 12;
  start_halves();
  ShardedClient client = connect_sharded();
  Result<ShardedPublisher> publisher = client.publish("balls", {.lease = 60s});
  ASSERT_TRUE(publisher) << publisher.error().message;
  std::vector<ShardedPublisher::Object> balls;
  for (int pair = 0; pair < kPairs; ++pair) {
    for (const double x : {-0.5, 0.5}) {
      const auto ball = publisher->add({.name = std::to_string(pair) + (x < 0 ? "_west" : "_east"),
                                        .shape = {SphereShape{.radius_m = 0.3}},
                                        .pose = {.position = {x, 1.0 * pair, 50}}});
      ASSERT_TRUE(ball) << ball.error().message;
      balls.push_back(*ball);
    }
  }
  std::atomic<bool> is_over{false};
  std::thread mover([&] {
    for (int round = 0; !is_over.load(); ++round) {
      const double x = round % 2 == 0 ? 0.2 : 0.5;
      for (int i = 0; i < 2 * kPairs; ++i)
        static_cast<void>(publisher->move(balls[i], {.position = {i % 2 == 0 ? -x : x, 1.0 * (i / 2), 50}}));
      static_cast<void>(publisher->flush());
      // Else a busy machine has more to decide than it can, and the first event of a watch waits for all of it.
      if (round % 10 == 0) static_cast<void>(publisher->wait_applied(60s));
      std::this_thread::sleep_for(2ms);
    }
  });
  int heard = 0;
  for (int i = 0; i < kWatches; ++i) {
    Result<ShardedWatch> watch = client.watch();
    EXPECT_TRUE(watch);
    if (!watch) break;
    // How soon the first event comes is not the claim here; that the watch ends amid events is.
    EXPECT_TRUE(watch->next(60s)) << "watch " << i << ", settled " << watch->settled().count() << " ns, gaps "
                                  << watch->gaps();
    for (int more = 0; more < 200 && watch->next(100ms); ++more) ++heard;
  }
  is_over.store(true);
  mover.join();
  EXPECT_GT(heard, kWatches);
}

}  // namespace
}  // namespace collided
