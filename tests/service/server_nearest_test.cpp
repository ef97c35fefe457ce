// Questions that stay for the nearest, over the wire: from whom to whom, kept ones after a kill, owned ones after theirs.
#include <csignal>
#include <thread>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using Names = std::vector<std::string>;

class ServerNearest : public testing_support::ServerTest {
 protected:
  static NearestWatch watch_nearest(Client& client, const NearestWatchOptions& options = {}) {
    Result<NearestWatch> watch = client.watch_nearest(options);
    EXPECT_TRUE(watch) << watch.error().message;
    EXPECT_TRUE(test::eventually([&] { return watch->in_step(); }));
    return std::move(*watch);
  }
  static NearestEvent next(NearestWatch& watch, std::chrono::milliseconds wait = 10s) {
    const std::optional<NearestEvent> event = watch.next(wait);
    EXPECT_TRUE(event) << "no event in time";
    return event.value_or(NearestEvent{});
  }
  static NearestQuestion question(const std::string& name, bool keep = false) {
    return {.name = name, .only = "door*", .to = "person", .within_m = 50, .keep = keep};
  }
  /// "question: answer", in order.
  static Names answers(Client& client) {
    Names all;
    const Result<std::vector<ListedNearest>> listed = client.nearest();
    if (!listed) return {listed.error().message};
    for (const ListedNearest& one : *listed) all.push_back(one.question.name + ": " + one.object);
    return all;
  }
  static void expect(const NearestEvent& event, const std::string& from, const std::string& to) {
    EXPECT_EQ(event.kind, NearestEventKind::changed);
    EXPECT_EQ(event.from, from);
    EXPECT_EQ(event.to, to);
  }
};

TEST_F(ServerNearest, AnotherIsToldFromWhomToWhomAndHowFar) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_nearest(question("escape")));
  NearestWatch watch = watch_nearest(client);
  Result<FenceWatch> fences = client.watch_fences();
  Result<MarginWatch> margins = client.watch_margins();
  ASSERT_TRUE(fences && margins);
  Publisher publisher = publish(client, "guide");
  add_ball(publisher, "door_a", at(0, 3, 2));
  add_ball(publisher, "door_b", at(20, 3, 2));
  const Publisher::Object person = add_ball(publisher, "person", at(1, 0, 2));
  const std::chrono::nanoseconds first = std::chrono::system_clock::now().time_since_epoch();
  ASSERT_TRUE(publisher.flush(first));
  NearestEvent event = next(watch);
  expect(event, "", "door_a");
  EXPECT_EQ(event.nearest, "escape");
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
  EXPECT_EQ(answers(client), Names{"escape: door_b"});
  ASSERT_TRUE(publisher.move(person, at(300, 0, 2)));
  ASSERT_TRUE(publisher.flush(first + 500ms));
  event = next(watch);
  expect(event, "door_b", "");
  EXPECT_EQ(answers(client), Names{"escape: "});
  EXPECT_EQ(watch.lost(), 0u);
  EXPECT_FALSE(fences->next(50ms)) << "it is no news of a fence";
  EXPECT_FALSE(margins->next(50ms));
}

TEST_F(ServerNearest, APassageBetweenTwoPosesIsTwoChanges) {
  start();
  Client client = connect();
  NearestQuestion asked{.name = "first", .only = "drone*", .point = Vec3(0, 0, 2), .within_m = 50};
  ASSERT_TRUE(client.add_nearest(asked));
  NearestWatch watch = watch_nearest(client);
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "drone_waits", at(0, 6, 2));
  const Publisher::Object flies = add_ball(publisher, "drone_flies", at(-40, 1, 2));
  ASSERT_TRUE(publisher.flush());
  expect(next(watch), "", "drone_waits");
  move(publisher, flies, at(40, 1, 2));
  expect(next(watch), "drone_waits", "drone_flies");
  expect(next(watch), "drone_flies", "drone_waits");
}

TEST_F(ServerNearest, WhoBeginsToWatchLaterIsToldWhoIsNearestAndWhyThatEnds) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "guide");
  const Publisher::Object door = add_ball(publisher, "door_a", at(0, 3, 2));
  add_ball(publisher, "door_b", at(0, 9, 2));
  add_ball(publisher, "person", at(0, 0, 2));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(client.add_nearest(question("escape")));
  ASSERT_TRUE(test::eventually([&] { return answers(client) == Names{"escape: door_a"}; }));
  NearestWatch watch = watch_nearest(client, {.only = "esc*"});
  const NearestEvent is = next(watch);
  EXPECT_EQ(is.kind, NearestEventKind::is);
  EXPECT_EQ(is.to, "door_a");
  EXPECT_NEAR(is.distance_m, 3 - 0.2, 1e-6);
  ASSERT_TRUE(publisher.remove(door));
  ASSERT_TRUE(publisher.flush());
  const NearestEvent next_door = next(watch);
  expect(next_door, "door_a", "door_b");
  EXPECT_EQ(next_door.reason, EndReason::removed);
  EXPECT_EQ(*client.remove_nearest("esc*"), 1u);
  const NearestEvent gone = next(watch);
  expect(gone, "door_b", "");
  EXPECT_EQ(gone.reason, EndReason::fence_removed);
  EXPECT_EQ(answers(client), Names());
}

TEST_F(ServerNearest, QuestionsAreListedAndRemovedApartFromFences) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_nearest(question("escape")));
  ASSERT_TRUE(client.add_fence({.name = "dock", .shape = {SphereShape{.radius_m = 1}}}));
  EXPECT_EQ(client.fences()->size(), 1u);
  EXPECT_EQ(client.nearest()->size(), 1u);
  EXPECT_EQ(*client.remove_fences("*"), 1u);
  EXPECT_EQ(answers(client), Names{"escape: "});
  for (NearestQuestion wrong : {NearestQuestion{.name = "no", .only = "a", .within_m = 1},
                                NearestQuestion{.name = "no", .only = "", .to = "b", .within_m = 1},
                                NearestQuestion{.name = "no", .only = "a", .to = "b"}, question("escape")})
    EXPECT_FALSE(client.add_nearest(wrong)) << wrong.name;
  EXPECT_FALSE(client.add_fence({.name = "escape", .shape = {SphereShape{.radius_m = 1}}}));
  EXPECT_EQ(*client.remove_nearest("*"), 1u);
}

TEST_F(ServerNearest, OneThatIsNotKeptGoesWithItsClient) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_nearest(question("stays", true)));
  {
    Client other = connect();
    ASSERT_TRUE(other.add_nearest(question("goes")));
    EXPECT_EQ(answers(client), (Names{"stays: ", "goes: "}));
  }
  EXPECT_TRUE(test::eventually([&] { return answers(client) == Names{"stays: "}; }, 15s));
}

TEST_F(ServerNearest, AKillLosesNoKeptQuestionAndTheWatchGoesOn) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_nearest(question("escape", true)));
  Publisher publisher = publish(client, "guide");
  add_ball(publisher, "door_a", at(0, 3, 2));
  add_ball(publisher, "door_b", at(20, 3, 2));
  const Publisher::Object person = add_ball(publisher, "person", at(0, 0, 2));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(test::eventually([&] { return answers(client) == Names{"escape: door_a"}; }));
  NearestWatch watch = watch_nearest(client);
  EXPECT_EQ(next(watch).to, "door_a");
  servers_.back()->signal(SIGKILL);
  servers_.back()->wait(5s);
  start({}, "server 1");
  Client again = connect();
  ASSERT_TRUE(test::eventually(
      [&] {
        move(publisher, person, at(0.1, 0, 2));
        return answers(again) == Names{"escape: door_a"};
      },
      15s));
  EXPECT_TRUE(test::eventually([&] { return watch.connected() && watch.in_step(); }, 15s));
  std::string is = "door_a";
  EXPECT_TRUE(test::eventually(
      [&] {
        move(publisher, person, at(19, 0, 2));
        while (const std::optional<NearestEvent> event = watch.next(20ms)) {
          // Its publisher defines it anew.
          const bool is_anew = event->reason == EndReason::geometry_changed;
          EXPECT_TRUE(is_anew || event->to != is) << "told twice, with sequence number " << event->sequence;
          is = event->to;
        }
        return is == "door_b";
      },
      15s));
}

// Nobody moves, and no publisher is alive: what commands put there is known up to now.
TEST_F(ServerNearest, WhatCommandsPutThereCounts) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_nearest(question("escape")));
  NearestWatch watch = watch_nearest(client);
  ASSERT_TRUE(client.add({.name = "person", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(0, 0, 2)}));
  ASSERT_TRUE(client.add({.name = "door_a", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(4, 0, 2)}));
  expect(next(watch), "", "door_a");
  ASSERT_TRUE(client.add({.name = "door_b", .shape = {SphereShape{.radius_m = 0.1}}, .pose = at(3, 0, 2)}));
  expect(next(watch), "door_a", "door_b");
}

}  // namespace
}  // namespace collided
