// Publishers that take over what the world has, and names that are taken.

#include <chrono>
#include <cmath>
#include <csignal>
#include <set>
#include <thread>

#include <collided/recording.hpp>
#include <collided/robot.hpp>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;

class ServerClaims : public testing_support::ServerTest {
 protected:
  /// The example's arm, loaded.
  static std::string arm() { return std::string(COLLIDED_SOURCE_DIR) + "/deploy/examples/arm.urdf"; }
  static Loaded load(Client& client, bool is_moving) {
    Result<Loaded> loaded = client.load(arm(), {.replace = true, .moving = is_moving});
    EXPECT_TRUE(loaded) << loaded.error().message;
    return loaded ? *loaded : Loaded{};
  }
  static Robot robot() {
    Result<Robot> robot = Robot::read(arm());
    EXPECT_TRUE(robot) << robot.error().message;
    return std::move(*robot);
  }
};

// All calls succeeded, and nothing was in the world: now the wait for it says so, and what to do.
TEST_F(ServerClaims, ATakenNameIsAnErrorOfTheWaitAndEntersOnceItIsFree) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "robot");
  add_ball(publisher, "free", at(40, 40, 40));
  EXPECT_TRUE(publisher.wait_applied(20s));
  add_ball(publisher, "warehouse/floor", at(50, 50, 50));
  const Publisher::Object second = add_ball(publisher, "late", at(60, 60, 60));
  const Result<void> applied = publisher.wait_applied(5s);
  ASSERT_FALSE(applied);
  EXPECT_EQ(applied.error().code, ErrorCode::refused);
  EXPECT_EQ(applied.error().message,
            "object 'warehouse/floor' is not in the world: the name is taken, by scene 'warehouse'");
  move(publisher, second, at(61, 60, 60));
  EXPECT_FALSE(publisher.wait_applied(5s)) << "it is still so";
  ASSERT_TRUE(client.clear({.scene = "warehouse"}));
  EXPECT_TRUE(test::eventually([&] { return static_cast<bool>(publisher.wait_applied(20s)); }));
  EXPECT_TRUE(client.get("warehouse/floor"));
  EXPECT_EQ(client.get("late")->position, Vec3(61, 60, 60));
}

// It gave up after 240 ms of silence, whatever its timeout.
TEST_F(ServerClaims, AWaitOutlastsAServersSilence) {
  testing_support::ChildProcess& server = start();
  Client client = connect();
  Publisher publisher = publish(client, "robot");
  add_ball(publisher, "ball", at(40, 40, 40));
  ASSERT_TRUE(publisher.wait_applied(20s));
  server.signal(SIGSTOP);
  add_ball(publisher, "late", at(50, 50, 50));
  std::jthread again([&] {
    std::this_thread::sleep_for(1s);
    server.signal(SIGCONT);
  });
  const Result<void> applied = publisher.wait_applied(60s);
  EXPECT_TRUE(applied) << applied.error().message;
  EXPECT_TRUE(client.get("late"));
}

// 257 publishers were 256, and the objects of one were nowhere, without a word.
TEST_F(ServerClaims, APublisherThatIsNotTakenHearsWhy) {
  start();
  Client client = connect();
  std::vector<Publisher> crowd;
  for (int i = 0; i <= 256; ++i) {
    crowd.push_back(publish(client, "crowd"));
    add_ball(crowd.back(), "ball" + std::to_string(i), at(40 + i, 40, 40));
  }
  // DDS may bring the publishers in another order than they were made.
  std::vector<std::size_t> refused;
  for (std::size_t i = 0; i < crowd.size(); ++i) {
    const Result<void> applied = crowd[i].wait_applied(20s);
    if (applied) continue;
    refused.push_back(i);
    EXPECT_EQ(applied.error().code, ErrorCode::refused);
    EXPECT_EQ(applied.error().message,
              "the server takes nothing of this publisher: its process has 256 publishers, the limit of one process");
  }
  ASSERT_EQ(refused.size(), 1U);
  std::swap(crowd[refused[0]], crowd.back());
  crowd.erase(crowd.begin());
  EXPECT_TRUE(test::eventually([&] {
    move(crowd.back(), 0, at(90, 90, 90));
    return static_cast<bool>(crowd.back().wait_applied(1s));
  })) << "it is taken once there is room";
}

TEST_F(ServerClaims, AReplayWhosePublisherIsNotTakenEndsWithTheReason) {
  start();
  Client client = connect();
  const ConnectOptions here{.domain = domain_, .wait = 10s};
  const std::string file = folder_.path() + "/ball.mcap";
  {
    Publisher publisher = publish(client, "recorded");
    add_ball(publisher, "recorded ball", at(40, 40, 40));
    ASSERT_TRUE(publisher.wait_applied(20s));
    ASSERT_TRUE(fetch_recording(here, 0s, file));
  }
  std::vector<Publisher> crowd;
  for (int i = 0; i < 256; ++i) {
    crowd.push_back(publish(client, "crowd"));
    add_ball(crowd.back(), "ball" + std::to_string(i), at(40 + i, 40, 40));
  }
  for (Publisher& publisher : crowd) ASSERT_TRUE(publisher.wait_applied(20s));
  const Result<ReplayReport> replayed = replay(here, {.path = file});
  ASSERT_FALSE(replayed);
  EXPECT_EQ(replayed.error().code, ErrorCode::refused);
  EXPECT_EQ(
      replayed.error().message,
      "replay: the server takes nothing of a recorded publisher: its process has 256 publishers, the limit of one "
      "process");
}

TEST_F(ServerClaims, AScenesLinksAreDrivenByThePublisherThatClaimsThem) {
  start();
  Client client = connect();
  EXPECT_EQ(load(client, true).objects, 4U);
  ASSERT_TRUE(client.add({.name = "post", .shape = {SphereShape{.radius_m = 0.05}}, .pose = at(0.8487, 0, 0.59)}));
  Result<Watch> watching = client.watch({.only = "post"});
  ASSERT_TRUE(watching && test::eventually([&] { return watching->in_step(); }));
  {
    Publisher publisher = publish(client, "driver");
    Result<PublishedRobot> arm = PublishedRobot::claim(client, publisher, robot());
    ASSERT_TRUE(arm) << arm.error().message;
    EXPECT_EQ(arm->object_count(), 4U);
    EXPECT_EQ(client.get("arm/hand")->publisher, "driver");
    // The shoulder turns by 90 degrees in small steps: the hand passes the post, just out of the reach of the forearm.
    for (int step = 0; step <= 90; step += 5) {
      const std::vector<JointValue> bent{{"shoulder", step * std::acos(-1.0) / 180}};
      ASSERT_TRUE(arm->set_joints(publisher, bent));
      ASSERT_TRUE(publisher.flush());
      ASSERT_TRUE(publisher.wait_applied(20s));
    }
    EXPECT_NEAR((client.get("arm/hand")->pose->position - Vec3(0.9, 0, 0.1)).norm(), 0, 1e-15);
    const Event began = next(*watching);
    EXPECT_EQ(began.kind, EventKind::began);
    EXPECT_EQ(std::set<std::string>({began.a, began.b}), std::set<std::string>({"arm/hand", "post"}));
    EXPECT_FALSE(client.move("arm/hand", at(0, 0, 9))) << "it has a publisher that lives";
    Publisher other = publish(client, "other");
    ASSERT_TRUE(other.claim("arm/hand", at(0, 0, 1)));
    const Result<void> refused = other.wait_applied(5s);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message,
              "object 'arm/hand' is not in the world: the name is taken, by publisher 'driver'");
  }
  // Given back where they stand: first to the other one, which waits for the hand, then to the world.
  EXPECT_TRUE(test::eventually([&] {
    const Result<ObjectDetails> fore = client.get("arm/fore");
    return fore && fore->publisher.empty();
  }));
  EXPECT_NEAR((client.get("arm/fore")->pose->position - Vec3(0.5, 0, 0.1)).norm(), 0, 1e-15);
  EXPECT_TRUE(client.move("arm/fore", at(0, 0, 9))) << "nobody publishes it any more";
}

TEST_F(ServerClaims, ARobotThatStandsStillOrIsNotThereIsRefused) {
  start();
  Client client = connect();
  Publisher publisher = publish(client, "driver");
  Result<PublishedRobot> arm = PublishedRobot::claim(client, publisher, robot());
  ASSERT_FALSE(arm);
  EXPECT_EQ(arm.error().message, "no link of robot 'arm' is in the world as 'arm/LINK'");
  load(client, false);
  arm = PublishedRobot::claim(client, publisher, robot());
  ASSERT_FALSE(arm);
  EXPECT_EQ(
      arm.error().message,
      "object 'arm/base' is not in the world: it was added as static; a scene is to be loaded as moving; so are 3 "
      "more");
}

// Each has an SRDF file that allows its neighbouring links to touch. Links once had layers by their numbers, the same for
// every robot, and so the two never met where the links' numbers were neighbours.
TEST_F(ServerClaims, TwoRobotsFromOneFileMeetEachOther) {
  start();
  Client client = connect();
  const std::string srdf = std::string(COLLIDED_SOURCE_DIR) + "/deploy/examples/arm.srdf";
  for (const char* name : {"left", "right"})
    ASSERT_TRUE(client.load(arm(), {.name = name, .srdf = srdf, .moving = true}));
  ASSERT_TRUE(
      client.add({.name = "cup", .shape = {SphereShape{.radius_m = 0.01}}, .pose = at(0, 0, 0.5), .layers = 8}));
  Publisher publisher = publish(client, "driver");
  ASSERT_TRUE(PublishedRobot::claim(client, publisher, robot(), {.scene = "left"}));
  Result<PublishedRobot> right =
      PublishedRobot::claim(client, publisher, robot(), {.scene = "right", .base = at(9, 0, 0)});
  ASSERT_TRUE(right) << right.error().message;
  Result<Watch> watching = client.watch();
  ASSERT_TRUE(watching && test::eventually([&] { return watching->in_step(); }));
  EXPECT_EQ(client.clearance("right/*", {.to = "left/*", .nearer_m = 1})->verdict, Verdict::miss);
  // The right hand comes to be within the left forearm.
  ASSERT_TRUE(right->set_base(publisher, at(0, 0, -0.25)));
  ASSERT_TRUE(publisher.flush());
  std::set<std::set<std::string>> awaited{{"right/hand", "left/fore"}, {"right/fore", "left/upper"}};
  while (!awaited.empty()) {
    const Event event = next(*watching);
    ASSERT_NE(event.sequence, 0U) << "no event in time";
    if (event.kind == EventKind::began) awaited.erase({event.a, event.b});
    EXPECT_FALSE(event.a == "right/hand" && event.b == "right/fore") << "neighbours of one robot";
  }
  EXPECT_EQ(client.clearance("right/hand", {.to = "left/fore"})->verdict, Verdict::hit);
  EXPECT_EQ(client.clearance("cup", {.to = "left/upper"})->verdict, Verdict::hit) << "layers are the user's";
  const WhatIfConfigurations thought{.objects = {"right/hand"}, .poses = {at(0, 0, 0.8)}};
  EXPECT_EQ(client.what_if(thought, {.against = "left/fore"})->configurations[0].verdict, Verdict::hit);
  EXPECT_EQ(client.what_if(thought, {.against = "right/fore"})->configurations[0].verdict, Verdict::miss);
}

// A server that starts anew has the scene from its journal; the publisher claims its links again by itself.
TEST_F(ServerClaims, AfterACrashTheLinksAreClaimedAgainAtTheirNewestPoses) {
  start();
  Client client = connect();
  load(client, true);
  Publisher publisher = publish(client, "driver");
  Result<PublishedRobot> arm = PublishedRobot::claim(client, publisher, robot());
  ASSERT_TRUE(arm) << arm.error().message;
  const std::vector<JointValue> bent{{"shoulder", std::acos(-1.0) / 2}};
  ASSERT_TRUE(arm->set_joints(publisher, bent));
  ASSERT_TRUE(publisher.flush());
  ASSERT_TRUE(publisher.wait_applied(20s));
  servers_.back()->signal(SIGKILL);
  servers_.back()->wait(10s);
  start({}, "again");
  EXPECT_TRUE(test::eventually([&] {
    static_cast<void>(publisher.keep_alive());
    const Result<ObjectDetails> hand = client.get("arm/hand");
    return hand && hand->publisher == "driver" && (hand->pose->position - Vec3(0.9, 0, 0.1)).norm() < 1e-12;
  }));
}

}  // namespace
}  // namespace collided
