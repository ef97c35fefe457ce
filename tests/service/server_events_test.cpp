#include "idl/topics.hpp"
#include "tests/service/server_fixture.hpp"

#include <csignal>
#include <thread>

namespace collided {
namespace {

using namespace std::chrono_literals;
using ServerEvents = testing_support::ServerTest;

void expect_pair(const Event& event, const std::string& a, const std::string& b) {
  EXPECT_EQ(std::minmax(event.a, event.b), std::minmax(a, b));
}

// A publisher that was away for longer than a server waits for most defines everything again. What it moves then is still a
// motion: a wall that it crosses is met, and what held goes on.
TEST_F(ServerEvents, WhatMovesWhileItIsDefinedAgainIsMovedAndNotPlaced) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "moving");
  ASSERT_TRUE(client.command("add", R"({"name":"wall","pose":[0,0,20,1,0,0,0]})", {BoxShape{.half_m = {0.01, 5, 5}}}));
  const Publisher::Object ball = add_ball(publisher, "ball", at(1, 0, 20));
  const Publisher::Object lid = add_ball(publisher, "lid", at(3, 0, 20.15));
  add_ball(publisher, "pot", at(3, 0, 20));
  move(publisher, ball, at(2, 0, 20));
  ASSERT_TRUE(publisher.wait_applied(20s));
  Watch watching = watch(client);
  EXPECT_EQ(next(watching).kind, EventKind::open);
  std::this_thread::sleep_for(std::chrono::nanoseconds(wire_contract::kPublisherLeaseNs) + 200ms);
  ASSERT_TRUE(publisher.move(ball, at(-2, 0, 20)));
  move(publisher, lid, at(3, 0, 20.16));
  ASSERT_TRUE(publisher.wait_applied(20s));
  const Event began = next(watching);
  EXPECT_EQ(began.kind, EventKind::began);
  EXPECT_EQ(std::min(began.a, began.b), "ball");
  const Event ended = next(watching);
  EXPECT_EQ(ended.kind, EventKind::ended);
  EXPECT_EQ(ended.reason, EndReason::separated);
  EXPECT_FALSE(watching.next(300ms)) << "pot and lid touch all the while";
}

TEST_F(ServerEvents, ABallThatTouchesTheFloorBeginsAndEnds) {
  start();
  Client client = connect();
  Watch events = watch(client);
  Publisher publisher = publish(client, "thrower");
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 1));
  move(publisher, ball, at(6, 0, 0.05));
  const Event began = next(events);
  EXPECT_EQ(began.kind, EventKind::began);
  expect_pair(began, "ball", "warehouse/floor");
  EXPECT_NEAR(began.depth_m, 0.05, 1e-9);
  move(publisher, ball, at(6, 0, 0.5));
  const Event ended = next(events);
  EXPECT_EQ(ended.kind, EventKind::ended);
  EXPECT_EQ(ended.reason, EndReason::separated);
  EXPECT_EQ(ended.episode, began.episode);
  EXPECT_EQ(ended.sequence, began.sequence + 1);
}

// Every accepted pose is examined: two poses in a hurry do not hide the contact between them.
TEST_F(ServerEvents, PosesInAHurryAreEachLookedAt) {
  start();
  Client client = connect();
  Watch events = watch(client);
  Publisher publisher = publish(client, "thrower");
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 1));
  constexpr int kTouches = 50;
  for (int i = 0; i < kTouches; ++i) {
    move(publisher, ball, at(6, 0, 0.05));
    move(publisher, ball, at(6, 0, 1));
  }
  ASSERT_TRUE(publisher.wait_applied(20s));
  for (int i = 0; i < kTouches; ++i) {
    ASSERT_EQ(next(events).kind, EventKind::began) << i;
    ASSERT_EQ(next(events).kind, EventKind::ended) << i;
  }
}

TEST_F(ServerEvents, APublisherThatOffersALongLeaseMayBeSilent) {
  start({"--forget-after", "0"});
  Client client = connect();
  for (const std::chrono::nanoseconds lease : std::initializer_list<std::chrono::nanoseconds>{99ms, 25h, -1s}) {
    const Result<Publisher> refused = client.publish("refused", {.lease = lease});
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::bad_input);
    EXPECT_NE(refused.error().message.find("; allowed 100 ms to a day"), std::string::npos) << refused.error().message;
  }
  Watch events = watch(client);
  Publisher brief = publish(client, "brief", 100ms);
  Publisher silent = publish(client, "silent", 60s);
  add_ball(brief, "gone", at(4, 0, 0.05));
  add_ball(silent, "stays", at(8, 0, 0.05));
  ASSERT_TRUE(silent.flush());
  ASSERT_TRUE(brief.flush());
  std::vector<std::string> ended;
  while (const std::optional<Event> event = events.next(1500ms))
    if (event->kind == EventKind::ended) ended.push_back(event->a == "gone" || event->b == "gone" ? "gone" : "another");
  EXPECT_EQ(ended, std::vector<std::string>{"gone"});
}

// Silence is not absence: until its objects leave, what they could change is undecided, and flush() reports the loss.
TEST_F(ServerEvents, ASilentPublishersPlaceIsNotCalledFreeBeforeItIsForgotten) {
  start({"--forget-after", "1s"});
  Client client = connect();
  Publisher publisher = publish(client, "tracker", 300ms);
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 3));
  move(publisher, ball, at(6, 0, 3));
  ASSERT_TRUE(publisher.wait_applied(20s));
  const auto ask = [&] { return client.ask(SphereQuestion{.center = {6, 0, 3}, .radius_m = 0.05}); };
  Result<Answer> answer = ask();
  ASSERT_EQ(answer->verdict, Verdict::hit);
  const auto began = std::chrono::steady_clock::now();
  bool was_stale = false;
  while ((answer = ask())->verdict != Verdict::miss) {
    was_stale = was_stale || (answer->verdict == Verdict::hit ? !answer->hits.empty() && answer->hits[0].stale
                                                              : answer->reason == UndecidedReason::stale_object);
    ASSERT_LT(std::chrono::steady_clock::now() - began, 20s);
  }
  EXPECT_TRUE(was_stale);
  EXPECT_GE(std::chrono::steady_clock::now() - began, 1s);
  ASSERT_TRUE(publisher.move(ball, at(6, 0, 3)));
  const Result<FlushReport> flushed = publisher.flush();
  ASSERT_TRUE(flushed);
  EXPECT_NE(flushed->lost.find("publisher 'tracker' was silent for "), std::string::npos) << flushed->lost;
  EXPECT_NE(flushed->lost.find("publish with a longer lease"), std::string::npos) << flushed->lost;
  ASSERT_TRUE(publisher.wait_applied(20s));
  EXPECT_EQ(client.ask(SphereQuestion{.center = {6, 0, 3}, .radius_m = 0.05}, {.fresh = true})->verdict, Verdict::hit);
}

TEST_F(ServerEvents, ASilentPublishersContactsEnd) {
  start({"--forget-after", "1s"});
  Client client = connect();
  Watch events = watch(client);
  Publisher publisher = publish(client, "silent", 500ms);
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 1));
  move(publisher, ball, at(6, 0, 0.05));
  EXPECT_EQ(next(events).kind, EventKind::began);
  const Event ended = next(events, 3s);  // says nothing more: its lease runs out after 0.5 s
  EXPECT_EQ(ended.kind, EventKind::ended);
  EXPECT_EQ(ended.reason, EndReason::publisher_lost);
  const Event doubted = next(events);
  EXPECT_EQ(doubted.kind, EventKind::began);
  EXPECT_EQ(doubted.doubt, Doubt::publisher_lost) << "it may have moved on";
  const Event left = next(events, 5s);
  EXPECT_EQ(left.kind, EventKind::ended);
  EXPECT_EQ(left.reason, EndReason::publisher_lost);
  EXPECT_EQ(client.ask(SphereQuestion{.center = {6, 0, 0.5}, .radius_m = 0.4})->verdict, Verdict::miss);
  // Back again: what it had is in the world again, where it was.
  move(publisher, ball, at(6, 0, 0.05));
  const Event again = next(events);
  EXPECT_EQ(again.kind, EventKind::began);
  expect_pair(again, "ball", "warehouse/floor");
}

TEST_F(ServerEvents, AFrozenObjectStaysAndIsStale) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "silent", 500ms);
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 1), LostPolicy::freeze);
  move(publisher, ball, at(6, 0, 2));
  ASSERT_TRUE(publisher.wait_applied(20s));
  const RayQuestion down{.origin = {6, 0, 5}, .direction = {0, 0, -1}};
  EXPECT_EQ(client.ask(down)->verdict, Verdict::hit);
  Result<Answer> stale = client.ask(down);
  ASSERT_TRUE(
      test::eventually([&] { return (stale = client.ask(down)) && !stale->hits.empty() && stale->hits[0].stale; }));
  ASSERT_EQ(stale->hits.size(), 1U);
  EXPECT_EQ(stale->hits[0].object, "ball");
  EXPECT_TRUE(stale->hits[0].stale);
  move(publisher, ball, at(6, 0, 2));
  ASSERT_TRUE(publisher.wait_applied(20s));
  EXPECT_FALSE(client.ask(down, {.fresh = true})->hits.at(0).stale);
}

TEST_F(ServerEvents, WhoComesLateGetsWhatIsOpen) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "thrower");
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 1));
  move(publisher, ball, at(6, 0, 0.05));
  ASSERT_TRUE(publisher.wait_applied(20s));
  Client late = connect();
  Watch events = watch(late);
  std::optional<Event> open;
  for (int i = 0; i < 50 && !open; ++i) {
    open = events.next(100ms);
    ASSERT_TRUE(publisher.keep_alive());
  }
  ASSERT_TRUE(open);
  EXPECT_EQ(open->kind, EventKind::open);
  expect_pair(*open, "ball", "warehouse/floor");
  EXPECT_EQ(events.open_contacts(), 1U);
}

TEST_F(ServerEvents, StoppingEndsTheContacts) {
  testing_support::ChildProcess& server = start();
  Client client = connect();
  Watch events = watch(client);
  Publisher publisher = publish(client, "thrower");
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 1));
  move(publisher, ball, at(6, 0, 0.05));
  EXPECT_EQ(next(events).kind, EventKind::began);
  server.signal(SIGTERM);
  EXPECT_EQ(server.wait(10s), 0);
  const Event ended = next(events);
  EXPECT_EQ(ended.kind, EventKind::ended);
  EXPECT_EQ(ended.reason, EndReason::server_stopping);
  EXPECT_EQ(events.open_contacts(), 0U);
}

// The name stays with the first; the second's object comes in when the first has gone.
TEST_F(ServerEvents, ANameIsGivenOnForWhoWaits) {
  start();
  Client first_client = connect();
  Client second_client = connect();
  Watch events = watch(first_client);
  std::optional<Publisher> first = publish(first_client, "first");
  Publisher second = publish(second_client, "second");
  add_ball(*first, "ball", at(6, 0, 3));
  ASSERT_TRUE(first->wait_applied(20s));
  const Publisher::Object wanted = add_ball(second, "ball", at(6, 0, 1));
  move(second, wanted, at(6, 0, 0.05));
  const Result<void> applied = second.wait_applied(5s);
  ASSERT_FALSE(applied) << "nothing of it is in the world";
  EXPECT_EQ(applied.error().message, "object 'ball' is not in the world: the name is taken, by publisher 'first'");
  EXPECT_FALSE(events.next(300ms)) << "the second's ball touches the floor, but is not in the world";
  ASSERT_TRUE(second.keep_alive());
  first.reset();
  const Event began = next(events, 2s);
  EXPECT_EQ(began.kind, EventKind::began);
  expect_pair(began, "ball", "warehouse/floor");
}

// A server that crashes and comes back: its publisher's object returns by itself, what held before holds on, and until
// everybody is back nothing is called a miss.
TEST_F(ServerEvents, ACrashIsRecoveredFrom) {
  testing_support::ChildProcess& first = start({}, "first");
  Client client = connect();
  Watch events = watch(client);
  Publisher publisher = publish(client, "thrower");
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 1));
  move(publisher, ball, at(6, 0, 0.05));
  EXPECT_EQ(next(events).kind, EventKind::began);
  first.signal(SIGKILL);
  first.wait(5s);
  start({}, "second");
  Client other = connect();
  const RayQuestion up{.origin = {6, 0, 1}, .direction = {0, 0, 1}};
  // Not where the ball was defined: that much of it DDS brings at once, and it is where the ball is no longer.
  const RayQuestion aside{.origin = {9, 0, 1}, .direction = {0, 0, 1}};
  EXPECT_EQ(other.ask(aside)->reason, UndecidedReason::recovering);
  const auto until = std::chrono::steady_clock::now() + 15s;
  while (std::chrono::steady_clock::now() < until && !(other.status() && other.status()->state == "ready")) {
    move(publisher, ball, at(6, 0, 0.05));
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_EQ(other.ask(up)->verdict, Verdict::miss);
  const Result<Answer> down = other.ask(RayQuestion{.origin = {6, 0, 5}, .direction = {0, 0, -1}});
  ASSERT_TRUE(down);
  EXPECT_EQ(down->hits.at(0).object, "ball");
  EXPECT_TRUE(test::eventually([&] { return events.in_step() && events.open_contacts() == 1U; }));
}

// 142 balls in one place are 10,011 contacts.
TEST_F(ServerEvents, WhoComesLateLearnsTenThousandContacts) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "crowd");
  constexpr std::size_t kBalls = 142;
  for (std::size_t i = 0; i < kBalls; ++i)
    add_ball(publisher, "ball " + std::to_string(i), at(60, 0.0001 * static_cast<double>(i), 50));
  ASSERT_TRUE(publisher.wait_applied(10s));
  const auto joined = std::chrono::steady_clock::now();
  Result<Watch> watch = client.watch();
  ASSERT_TRUE(watch);
  constexpr std::size_t kContacts = kBalls * (kBalls - 1) / 2;
  while (watch->open_contacts() < kContacts && std::chrono::steady_clock::now() - joined < 20s) {
    ASSERT_TRUE(publisher.keep_alive());
    std::this_thread::sleep_for(2ms);
  }
  EXPECT_EQ(watch->open_contacts(), kContacts);
  std::printf("complete_ms=%.0f\n",
              std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - joined).count());
}

// A subscriber that stands still neither slows the server nor costs its peers an event; awake again it catches up.
TEST_F(ServerEvents, AFrozenSubscriberIsNobodyElsesTrouble) {
  start();
  Client client = connect();
  Watch healthy = watch(client);
  testing_support::ChildProcess frozen({COLLIDED_CLI, "--domain", std::to_string(domain_), "watch", "--json"},
                                       folder_.path(), "frozen");
  Publisher publisher = publish(client, "thrower");
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 1));
  move(publisher, ball, at(6, 0, 0.05));
  EXPECT_EQ(next(healthy).kind, EventKind::began);
  ASSERT_TRUE(frozen.says("\"ball\"", 10s));
  frozen.signal(SIGSTOP);
  constexpr int kTouches = 5'000;
  double slowest_ms = 0;
  int slow = 0;
  for (int i = 0; i < kTouches; ++i) {
    const auto before = std::chrono::steady_clock::now();
    move(publisher, ball, at(6, 0, 1));
    move(publisher, ball, at(6, 0, 0.05));
    const double took_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count();
    slowest_ms = std::max(slowest_ms, took_ms);
    slow += took_ms > 5 ? 1 : 0;
    if (i % 100 == 99) { ASSERT_TRUE(publisher.wait_applied(10s)); }
  }
  for (int i = 0; i < kTouches; ++i) {
    ASSERT_EQ(next(healthy).kind, EventKind::ended) << i;
    ASSERT_EQ(next(healthy).kind, EventKind::began) << i;
  }
  EXPECT_EQ(healthy.lost(), 0u);
  EXPECT_EQ(healthy.resyncs(), 0u);
  // Other programs of a full machine take turns of some milliseconds now and then; who waits for acknowledgements, the frozen
  // one's or others', does so whenever what may be under way is, one time in dozens.
  EXPECT_LE(slow, kTouches / 100) << "of " << kTouches << " pairs of flushes took more than 5 ms";
  const auto awake = std::chrono::steady_clock::now();
  frozen.signal(SIGCONT);
  move(publisher, ball, at(6, 5, 3));
  EXPECT_EQ(next(healthy).kind, EventKind::ended);
  const Publisher::Object last = add_ball(publisher, "the last one", at(8, 0, 0.05));
  EXPECT_TRUE(frozen.says("the last one", 10s)) << "it goes on where the world is now";
  static_cast<void>(last);
  const double resync_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - awake).count();
  EXPECT_LT(resync_ms, 1'000);
  std::printf("max_write_ms=%.1f healthy_lost=%llu resync_ms=%.0f\n", slowest_ms,
              static_cast<unsigned long long>(healthy.lost()), resync_ms);
}

// DDS holds on to a killed server's reader for ten seconds, and it acknowledges nothing; the next server gets every pose.
TEST_F(ServerEvents, ADeadServersReaderHoldsNobodyUp) {
  testing_support::ChildProcess& first = start({}, "first");
  Client client = connect();
  Publisher publisher = publish(client, "thrower");
  const Publisher::Object ball = add_ball(publisher, "ball", at(6, 0, 1));
  first.signal(SIGKILL);
  first.wait(5s);
  start({}, "second");
  int held_up = 0;
  for (int i = 0; i < 300; ++i) {
    EXPECT_TRUE(publisher.move(ball, at(6, 0, 1 + 0.01 * i)));
    held_up += publisher.flush() ? 0 : 1;
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_EQ(held_up, 0);
  EXPECT_TRUE(publisher.wait_applied(20s));
  const auto leaving = std::chrono::steady_clock::now();
  { const Publisher gone = std::move(publisher); }
  { const Client gone = std::move(client); }
  EXPECT_LT(std::chrono::steady_clock::now() - leaving, 1s) << "nor whoever leaves";
}

// The same in batches of thousands of poses, which fill what a writer may keep.
TEST_F(ServerEvents, ADeadServersReaderHoldsNoCrowdUp) {
  testing_support::ChildProcess& first = start({}, "first");
  Client client = connect();
  Publisher publisher = publish(client, "thrower");
  std::vector<Publisher::Object> balls;
  for (int i = 0; i < 4'000; ++i)
    balls.push_back(add_ball(publisher, "ball " + std::to_string(i), at(6 + 3 * i, 0, 1)));
  ASSERT_TRUE(publisher.wait_applied(10s));
  first.signal(SIGKILL);
  first.wait(5s);
  start({}, "second");
  int held_up = 0;
  double slowest_ms = 0;
  for (int round = 0; round < 150; ++round) {
    for (std::size_t i = 0; i < balls.size(); ++i)
      static_cast<void>(publisher.move(balls[i], at(6 + 3 * static_cast<double>(i), 0, 1 + 0.01 * round)));
    const auto before = std::chrono::steady_clock::now();
    held_up += publisher.flush() ? 0 : 1;
    slowest_ms = std::max(slowest_ms,
                          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - before).count());
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_EQ(held_up, 0) << "flushes; the slowest took " << slowest_ms << " ms";
  EXPECT_TRUE(publisher.wait_applied(20s));
}

// Objects and scenes that commands added are there again after a crash and after a stop; those that were removed are not.
TEST_F(ServerEvents, WhatCommandsAddedOutlivesACrashAndAStop) {
  const std::string scene = folder_.write("plate.obj", "v 50 0 0\nv 51 0 0\nv 50 1 0\nf 1 2 3\n");
  const auto run = [&](const std::vector<std::string>& words) {
    std::vector<std::string> command{COLLIDED_CLI, "--domain", std::to_string(domain_)};
    command.insert(command.end(), words.begin(), words.end());
    testing_support::ChildProcess asker(command, folder_.path(), "asker");
    return asker.wait(20s) == 0;
  };
  const auto is_there = [&](double x) {
    Client client = connect();
    const auto until = std::chrono::steady_clock::now() + 15s;
    while (std::chrono::steady_clock::now() < until && !(client.status() && client.status()->state == "ready"))
      std::this_thread::sleep_for(20ms);
    return client.ask(RayQuestion{.origin = {x, 0.2, 5}, .direction = {0, 0, -1}})->verdict == Verdict::hit;
  };
  testing_support::ChildProcess& first = start({}, "first");
  EXPECT_TRUE(run({"add", "crate", "box", "0.4", "0.4", "0.4", "--at", "60.2", "0.2", "2"}));
  EXPECT_TRUE(run({"add", "barrel", "sphere", "0.5", "--at", "70.2", "0.2", "2"}));
  EXPECT_TRUE(run({"load", scene}));
  EXPECT_TRUE(run({"rm", "barrel"}));
  first.signal(SIGKILL);
  first.wait(5s);
  testing_support::ChildProcess& second = start({}, "second");
  EXPECT_TRUE(is_there(60.2));
  EXPECT_TRUE(is_there(50.2));
  EXPECT_FALSE(is_there(70.2));
  second.signal(SIGKILL);
  second.wait(5s);
  testing_support::ChildProcess& third = start({}, "third");
  EXPECT_TRUE(is_there(60.2)) << "a second crash loses nothing either";
  third.signal(SIGTERM);
  third.wait(10s);
  start({}, "fourth");
  EXPECT_TRUE(is_there(60.2)) << "and so does a stop";
  EXPECT_FALSE(is_there(70.2));
}

}  // namespace
}  // namespace collided
