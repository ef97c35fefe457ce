// Publishers that take over what the world has, and names that are taken.

#include <cmath>
#include <set>

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
  EXPECT_TRUE(publisher.wait_applied(5s));
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
  EXPECT_TRUE(test::eventually([&] { return static_cast<bool>(publisher.wait_applied(5s)); }));
  EXPECT_TRUE(client.get("warehouse/floor"));
  EXPECT_EQ(client.get("late")->position, Vec3(61, 60, 60));
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
      ASSERT_TRUE(publisher.wait_applied(5s));
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
  ASSERT_TRUE(publisher.wait_applied(5s));
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
