// Fences over the wire: who comes in and goes out, kept ones after a kill, owned ones after their client.
#include <csignal>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ServerFences : public testing_support::ServerTest {
 protected:
  static FenceWatch watch_fences(Client& client) {
    Result<FenceWatch> watch = client.watch_fences();
    EXPECT_TRUE(watch) << watch.error().message;
    EXPECT_TRUE(test::eventually([&] { return watch->in_step(); }));
    return std::move(*watch);
  }
  static FenceEvent next(FenceWatch& watch, std::chrono::milliseconds wait = 5s) {
    const std::optional<FenceEvent> event = watch.next(wait);
    EXPECT_TRUE(event) << "no event in time";
    return event.value_or(FenceEvent{});
  }
  static Fence box(const std::string& name, const Vec3& low, const Vec3& high) {
    return {.name = name, .shape = {BoxShape{.half_m = (high - low) / 2, .center = (low + high) / 2}}};
  }
  static Fence kept(Fence fence) {
    fence.keep = true;
    return fence;
  }
  static std::vector<std::string> fence_names(Client& client) { return fences_like(client, ""); }
  static std::vector<std::string> fences_like(Client& client, const std::string& glob) {
    std::vector<std::string> names;
    const Result<std::vector<ListedFence>> fences = client.fences(glob);
    if (!fences) return {fences.error().message};
    for (const ListedFence& fence : *fences) names.push_back(fence.name);
    std::sort(names.begin(), names.end());
    return names;
  }
  void expect(const FenceEvent& event, FenceEventKind kind, const std::string& object, const std::string& fence) {
    EXPECT_EQ(event.kind, kind);
    EXPECT_EQ(event.object, object);
    EXPECT_EQ(event.fence, fence);
  }
};

using Names = std::vector<std::string>;

TEST_F(ServerFences, WhoComesInAndGoesOutIsTold) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_fence(box("dock", {5, -1, 1}, {7, 1, 3})));
  FenceWatch watch = watch_fences(client);
  Publisher publisher = publish(client, "pilot");
  const Publisher::Object drone = add_ball(publisher, "drone", at(0, 0, 2));
  move(publisher, drone, at(6, 0, 2));
  const FenceEvent came = next(watch);
  expect(came, FenceEventKind::enter, "drone", "dock");
  EXPECT_NEAR(came.point.x(), 5, 1e-6);
  EXPECT_GE(came.bracket_low_s, came.bracket_high_s);
  // In, across a wall that no sample touches, and out of all.
  ASSERT_TRUE(client.add_fence(box("wire", {8, -1, 1}, {8.01, 1, 3})));
  EXPECT_EQ(client.fences("dock")->at(0).inside, Names{"drone"});
  move(publisher, drone, at(12, 0, 2));
  const FenceEvent left = next(watch);
  expect(left, FenceEventKind::exit, "drone", "dock");
  EXPECT_EQ(left.reason, EndReason::separated);
  EXPECT_EQ(left.episode, came.sequence);
  const FenceEvent crossed = next(watch);
  expect(crossed, FenceEventKind::cross, "drone", "wire");
  EXPECT_GT(crossed.bracket_low_s, crossed.left_high_s);
  EXPECT_EQ(watch.resyncs(), 0u);
  EXPECT_EQ(watch.lost(), 0u);
}

TEST_F(ServerFences, WhoBeginsToWatchLaterIsToldWhoIsIn) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "pilot");
  add_ball(publisher, "drone", at(6, 0, 2));
  ASSERT_TRUE(client.add_fence(box("dock", {5, -1, 1}, {7, 1, 3})));
  ASSERT_TRUE(test::eventually([&] { return client.fences("dock")->at(0).inside == Names{"drone"}; }));
  FenceWatch watch = watch_fences(client);
  expect(next(watch), FenceEventKind::inside, "drone", "dock");
  EXPECT_EQ(*client.remove_fences("do*"), 1u);
  const FenceEvent left = next(watch);
  expect(left, FenceEventKind::exit, "drone", "dock");
  EXPECT_EQ(left.reason, EndReason::fence_removed);
  EXPECT_EQ(fence_names(client), Names());
}

TEST_F(ServerFences, AFenceTellsWhatItIsAskedTo) {
  start();
  Client client = connect();
  Fence exits = box("exits", {5, -1, 1}, {7, 1, 3});
  exits.enter = exits.cross = false;
  Fence passages = box("passages", {5, -1, 1}, {7, 1, 3});
  passages.enter = passages.exit = false;
  ASSERT_TRUE(client.add_fence(exits));
  ASSERT_TRUE(client.add_fence(passages));
  FenceWatch watch = watch_fences(client);
  Publisher publisher = publish(client, "pilot");
  const Publisher::Object drone = add_ball(publisher, "drone", at(0, 0, 2));
  move(publisher, drone, at(6, 0, 2));
  move(publisher, drone, at(9, 0, 2));
  expect(next(watch), FenceEventKind::exit, "drone", "exits");
  // A passage, which the one tells as such and the other as its going out.
  move(publisher, drone, at(0, 0, 2));
  expect(next(watch), FenceEventKind::exit, "drone", "exits");
  expect(next(watch), FenceEventKind::cross, "drone", "passages");
  EXPECT_FALSE(watch.next(200ms));
}

TEST_F(ServerFences, AFenceGoesWithItsCarrier) {
  start();
  Client client = connect();
  ASSERT_TRUE(
      client.add_fence({.name = "around", .shape = {SphereShape{.radius_m = 1}}, .to = "person", .only = "robot*"}));
  FenceWatch watch = watch_fences(client);
  Publisher people = publish(client, "people");
  Publisher robots = publish(client, "robots");
  const Publisher::Object person = add_ball(people, "person", at(0, 0, 2));
  const Publisher::Object robot = add_ball(robots, "robot", at(5, 0, 2));
  move(people, person, at(0, 0, 2));
  move(robots, robot, at(5, 0, 2));
  // Decided as soon as both have said where they are at one time.
  std::optional<FenceEvent> came;
  EXPECT_TRUE(test::eventually([&] {
    move(people, person, at(4.5, 0, 2));
    move(robots, robot, at(5, 0, 2));
    return (came = watch.next(20ms)).has_value();
  }));
  ASSERT_TRUE(came);
  expect(*came, FenceEventKind::enter, "robot", "around");
}

TEST_F(ServerFences, APrismNeedNotBeConvex) {
  start();
  Client client = connect();
  // An L: the drone is in its notch first.
  ASSERT_TRUE(client.add_fence(
      {.name = "yard",
       .prism = Prism{.corners = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 4}, {0, 4}}, .low_m = 1, .high_m = 3}}));
  FenceWatch watch = watch_fences(client);
  Publisher publisher = publish(client, "pilot");
  const Publisher::Object drone = add_ball(publisher, "drone", at(3, 3, 2));
  move(publisher, drone, at(3, 3, 2.1));
  EXPECT_FALSE(watch.next(200ms));
  move(publisher, drone, at(0.5, 3, 2));
  expect(next(watch), FenceEventKind::enter, "drone", "yard");
  move(publisher, drone, at(0.5, 0.5, 2));
  EXPECT_FALSE(watch.next(200ms));
}

TEST_F(ServerFences, OneThatIsNotKeptGoesWithItsClient) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_fence(kept(box("stays", {0, 0, 5}, {1, 1, 6}))));
  {
    Client other = connect();
    ASSERT_TRUE(other.add_fence(box("goes", {0, 0, 5}, {1, 1, 6})));
    EXPECT_EQ(fence_names(client), (Names{"goes", "stays"}));
  }
  EXPECT_TRUE(test::eventually([&] { return fence_names(client) == Names{"stays"}; }, 15s));
}

TEST_F(ServerFences, AKillLosesNoKeptFenceAndTellsNothingTwice) {
  start();
  Client client = connect();
  ASSERT_TRUE(client.add_fence(kept(box("dock", {5, -1, 1}, {7, 1, 3}))));
  Publisher publisher = publish(client, "pilot");
  const Publisher::Object drone = add_ball(publisher, "drone", at(6, 0, 2));
  const auto holds_drone = [](Client& asked) {
    const Result<std::vector<ListedFence>> fences = asked.fences();
    return fences && fences->size() == 1 && fences->at(0).inside == Names{"drone"};
  };
  ASSERT_TRUE(test::eventually([&] { return holds_drone(client); }, 15s));
  FenceWatch watch = watch_fences(client);
  expect(next(watch), FenceEventKind::inside, "drone", "dock");
  servers_.back()->signal(SIGKILL);
  servers_.back()->wait(5s);
  start({}, "server 1");
  Client again = connect();
  ASSERT_TRUE(test::eventually(
      [&] {
        move(publisher, drone, at(6.1, 0, 2));
        return holds_drone(again);
      },
      15s));
  EXPECT_TRUE(test::eventually([&] { return watch.connected() && watch.in_step(); }, 15s));
  // It was in before and is in now: what is told, as of a publisher that defines it anew, begins with its going out.
  bool is_in = true;
  EXPECT_TRUE(test::eventually(
      [&] {
        move(publisher, drone, at(9, 0, 2));
        while (const std::optional<FenceEvent> event = watch.next(20ms)) {
          const bool came = event->kind == FenceEventKind::enter;
          EXPECT_NE(came, is_in) << "told twice, with sequence number " << event->sequence;
          is_in = came;
        }
        return !is_in;
      },
      15s));
}

TEST_F(ServerFences, ManyComeInFewMessages) {
  start();
  Client client = connect();
  std::vector<Fence> fences;
  constexpr int kCount = 20'000;  // more than a message holds
  for (int i = 0; i < kCount; ++i) {
    const Vec3 low(i % 200, i / 200, 5);
    fences.push_back(box("cell_" + std::to_string(i), low, low + Vec3(0.9, 0.9, 0.9)));
  }
  const auto began = std::chrono::steady_clock::now();
  const Result<void> added = client.add_fences(fences);
  ASSERT_TRUE(added) << added.error().message;
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
  std::printf("fences=%d seconds=%.3f\n", kCount, took.count());
  for (const char* name : {"cell_0", "cell_6999", "cell_19999"}) EXPECT_EQ(fences_like(client, name), Names{name});
  // One that is refused says which, and no other of its message is added: a recording knows it as refused.
  const std::vector<Fence> twice{box("new", {0, 0, 0}, {1, 1, 1}), fences[7]};
  const Result<void> refused = client.add_fences(twice);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("fence 2 of 2"), std::string::npos) << refused.error().message;
  EXPECT_EQ(fences_like(client, "new"), Names());
  EXPECT_TRUE(client.add_fence(twice[0])) << "its name is free";
}

TEST_F(ServerFences, WhatHoldsNothingIsRefused) {
  start();
  Client client = connect();
  const Result<void> surface = client.add_fence(
      {.name = "sheet", .shape = {MeshShape{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .triangles = {{0, 1, 2}}}}});
  ASSERT_FALSE(surface);
  EXPECT_NE(surface.error().message.find("holds nothing"), std::string::npos) << surface.error().message;
  const Result<void> crossing = client.add_fence(
      {.name = "bow", .prism = Prism{.corners = {{0, 0}, {1, 1}, {1, 0}, {0, 1}}, .low_m = 0, .high_m = 1}});
  ASSERT_FALSE(crossing);
  EXPECT_NE(crossing.error().message.find("crosses"), std::string::npos) << crossing.error().message;
  EXPECT_EQ(fence_names(client), Names());
}

}  // namespace
}  // namespace collided
