// Questions about one instant, over DDS.
#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using std::chrono::nanoseconds;

class ServerInstants : public testing_support::ServerTest {
 protected:
  static nanoseconds now() { return std::chrono::system_clock::now().time_since_epoch(); }
  static RayQuestion down(double x) { return {.origin = {x, 40, 50}, .direction = {0, 0, -1}, .length_m = 40}; }
  static Instant instant(nanoseconds time) { return {.kind = Instant::Kind::at, .time = time}; }
  static void say(Publisher& publisher, Publisher::Object object, double x, nanoseconds time) {
    ASSERT_TRUE(publisher.move(object, at(x, 40, 20)));
    ASSERT_TRUE(publisher.flush(time));
  }
  /// A flush without news has no number, so wait_applied() does not wait for what it says of the time.
  static bool settled_until(Client& client, nanoseconds time) {
    AskOptions settled;
    settled.as_of.kind = Instant::Kind::settled;
    const std::vector<RayQuestion> question{down(0)};
    return test::eventually([&] {
      const Result<Answers> answers = client.ask(std::span<const RayQuestion>(question), settled);
      return answers && answers->world_time >= time;
    });
  }
  static std::string met(Client& client, double x, const Instant& as_of) {
    AskOptions options;
    options.as_of = as_of;
    const Result<Answer> answer = client.ask(down(x), options);
    if (!answer) return answer.error().message;
    if (answer->verdict == Verdict::undecided) return "undecided";
    return answer->hits.empty() ? "nothing" : answer->hits[0].object;
  }
};

// One goes from 0 to 10 within a second, the other from 30 to 20 half a second behind: where they were at one instant no
// newest poses show.
TEST_F(ServerInstants, MoversOfTwoPublishersAreAskedForAtOneInstant) {
  start();
  Client client = connect();
  Publisher one = publish(client, "one");
  Publisher other = publish(client, "other");
  const Publisher::Object a = add_ball(one, "a", at(0, 40, 20));
  const Publisher::Object b = add_ball(other, "b", at(30, 40, 20));
  add_ball(one, "post", at(15, 40, 20));
  const nanoseconds began = now();
  say(one, a, 0, began);
  say(other, b, 30, began + 1ms);
  for (int tenth = 1; tenth <= 15; ++tenth) {
    std::this_thread::sleep_until(std::chrono::system_clock::time_point(
        std::chrono::duration_cast<std::chrono::system_clock::duration>(began + tenth * 100ms)));
    if (tenth <= 10) say(one, a, tenth, began + tenth * 100ms);
    else ASSERT_TRUE(one.flush(began + tenth * 100ms));
    if (tenth <= 5) ASSERT_TRUE(other.flush(began + tenth * 100ms));
    else say(other, b, 30 - (tenth - 5), began + tenth * 100ms);
  }
  ASSERT_TRUE(one.wait_applied(20s));
  ASSERT_TRUE(other.wait_applied(20s));
  ASSERT_TRUE(settled_until(client, began + 1500ms));
  EXPECT_EQ(met(client, 7.5, instant(began + 750ms)), "a");
  EXPECT_EQ(met(client, 27.5, instant(began + 750ms)), "b");
  EXPECT_EQ(met(client, 30, instant(began + 450ms)), "b") << "it still rested";
  EXPECT_EQ(met(client, 10, instant(began + 750ms)), "nothing");
  EXPECT_EQ(met(client, 10, {}), "a") << "latest";
  EXPECT_EQ(met(client, 20, {.kind = Instant::Kind::settled}), "b");
  const auto gap = [&](const Instant& as_of) {
    const Result<PairAnswer> pair = client.pair("a", "b", {.as_of = as_of});
    EXPECT_TRUE(pair) << pair.error().message;
    return pair && pair->verdict == Verdict::miss && !pair->stale ? pair->distance_m : -1;
  };
  EXPECT_NEAR(gap(instant(began + 750ms)), 20 - 0.2, 1e-9);
  EXPECT_NEAR(gap({}), 10 - 0.2, 1e-9) << "latest";
  // Only one has spoken of that instant; the other's went at 10 m/s when it was last heard of.
  std::this_thread::sleep_until(std::chrono::system_clock::time_point(
      std::chrono::duration_cast<std::chrono::system_clock::duration>(began + 1800ms)));
  ASSERT_TRUE(one.flush(began + 1800ms));
  Result<PairAnswer> later = Error{};
  ASSERT_TRUE(test::eventually([&] {
    return static_cast<bool>(later = client.pair("post", "b", {.as_of = instant(began + 1800ms)}));
  })) << later.error().message;
  EXPECT_EQ(later->verdict, Verdict::undecided);
  EXPECT_EQ(later->reason, UndecidedReason::stale_object);
  AskOptions settled;
  settled.as_of.kind = Instant::Kind::settled;
  const std::vector<RayQuestion> one_question{down(20)};
  const Result<Answers> answers = client.ask(std::span<const RayQuestion>(one_question), settled);
  ASSERT_TRUE(answers);
  EXPECT_GE(answers->world_time, began + 1500ms);
  EXPECT_LE(answers->world_time, now());
}

// Chunks of one request, of which the later ones are sent when the world has gone on.
TEST_F(ServerInstants, AllChunksOfARequestAreOfOneInstant) {
  start();
  Client client = connect();
  Publisher one = publish(client, "one");
  const Publisher::Object a = add_ball(one, "a", at(0, 40, 20));
  const nanoseconds began = now();
  for (int tenth = 0; tenth <= 5; ++tenth) {
    say(one, a, tenth, began + tenth * 100ms);
    std::this_thread::sleep_for(100ms);
  }
  AskOptions options;
  options.as_of = {.kind = Instant::Kind::back, .time = 300ms};
  const std::vector<RayQuestion> questions(20'000, {.origin = {-1, 40, 20}, .direction = {1, 0, 0}});
  const Result<Answers> answers = client.ask(std::span<const RayQuestion>(questions), options);
  ASSERT_TRUE(answers) << answers.error().message;
  for (const Answer& answer : answers->answers) {
    ASSERT_EQ(answer.hits.size(), 1u);
    ASSERT_EQ(answer.hits[0].distance_m, answers->answers[0].hits[0].distance_m);
  }
}

TEST_F(ServerInstants, WhatNobodyRemembersIsRefusedInWords) {
  start({"--memory", "2s"});
  Client client = connect();
  EXPECT_NE(met(client, 0, instant(now() - 60s)).find("this server remembers poses of the last"), std::string::npos)
      << met(client, 0, instant(now() - 60s));
  EXPECT_NE(met(client, 0, instant(now() + 60s)).find("ahead of the world's time"), std::string::npos);
  AskOptions options;
  options.as_of = {.kind = Instant::Kind::back, .time = -1ns};
  const Result<Answer> answer = client.ask(down(0), options);
  ASSERT_FALSE(answer);
  EXPECT_EQ(answer.error().message, "ray: the instant is -1 ns; allowed 0 or more");
  const Result<PairAnswer> pair = client.pair("a", "b", {.as_of = options.as_of});
  ASSERT_FALSE(pair);
  EXPECT_EQ(pair.error().message, "pair: the instant is -1 ns; allowed 0 or more");
  const Result<PairAnswer> old = client.pair("a", "b", {.as_of = instant(now() - 60s)});
  ASSERT_FALSE(old);
  EXPECT_NE(old.error().message.find("this server remembers poses of the last"), std::string::npos)
      << old.error().message;
}

TEST_F(ServerInstants, AServerWithoutMemorySaysSo) {
  start({"--memory", "off"});
  Client client = connect();
  EXPECT_NE(met(client, 0, {.kind = Instant::Kind::settled}).find("remembers no poses (--memory off)"),
            std::string::npos);
  EXPECT_EQ(met(client, 0, {}), "nothing");
}

}  // namespace
}  // namespace collided
