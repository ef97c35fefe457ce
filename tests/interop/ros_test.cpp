// `collide ros` between the server and a program that speaks as ROS 2's rmw_fastrtps does.

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

#include <collided/client.hpp>

#include "tests/service/server_fixture.hpp"

namespace collided {
namespace {

using namespace testing_support;

class Ros : public ServerTest {
 protected:
  ChildProcess bridge(const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{COLLIDED_CLI,         "ros",   "--domain", std::to_string(domain_), "--ros-domain",
                                   std::to_string(ros_), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return ChildProcess(words, folder_.path(), "bridge");
  }
  ChildProcess peer(const std::vector<std::string>& words, const std::string& name = "peer") {
    std::vector<std::string> all{COLLIDED_ROS_PEER, std::to_string(ros_)};
    all.insert(all.end(), words.begin(), words.end());
    return ChildProcess(all, folder_.path(), name);
  }
  /// Has the peer send once each side has met the other; then waits until it has sent.
  static void send(ChildProcess& peer, const ChildProcess& bridge, int broadcasters = 1) {
    ASSERT_TRUE(peer.says("ready", seconds(30))) << peer.errors() << bridge.errors();
    const std::string heard = "hears " + std::to_string(broadcasters) + " writer";
    ASSERT_TRUE(test::eventually([&] { return bridge.errors().find(heard) != std::string::npos; }, seconds(30)))
        << bridge.errors();
    peer.signal(SIGUSR1);
    ASSERT_TRUE(peer.says("sent", seconds(60))) << peer.errors() << bridge.errors();
  }
  std::string nothing() { return folder_.write("nothing.obj", "v 0 0 -50\nv 1 0 -50\nv 0 1 -50\nf 1 2 3\n"); }
  /// The counts with which the bridge ends.
  static nlohmann::json end(ChildProcess& bridge) {
    bridge.signal(SIGINT);
    EXPECT_EQ(bridge.wait(seconds(20)), 130) << bridge.errors();
    return nlohmann::json::parse(bridge.output(), nullptr, false);
  }
  static void add(Client& client, const std::string& name, const Pose& pose = {}) {
    const Result<Added> added =
        client.add({.name = name, .shape = {SphereShape{.radius_m = 0.1}}, .pose = pose, .group = 7});
    ASSERT_TRUE(added) << added.error().message;
  }
  static bool is_at(Client& client, const std::string& name, const Vec3& where, double within_m) {
    const Result<ObjectDetails> object = client.get(name);
    return object && object->pose && (object->pose->position - where).norm() <= within_m;
  }
  static double cpu_seconds(int pid) {
    std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
    std::string word;
    double ticks = 0;
    for (int field = 1; file >> word; ++field) {
      if (field == 14 || field == 15) ticks += std::strtod(word.c_str(), nullptr);
    }
    return ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
  }

  const int ros_ = own_domain();
};

// A chain of 50 frames, each turned in the one before: at the end every ball is where the product of all turns puts it.
TEST_F(Ros, FiftyFramesAtAHundredHertzMoveTheObjectsOfTheirNames) {
  start({nothing()});
  Client client = connect();
  constexpr int kFrames = 50, kMessages = 300;
  for (int frame = 0; frame <= kFrames; ++frame)
    add(client, (frame % 2 == 0 ? "arm/f" : "f") + std::to_string(frame), at(0, 0, 100));
  ChildProcess ros = bridge();
  ChildProcess tf = peer({"chain", std::to_string(kFrames), "100", std::to_string(kMessages)});
  send(tf, ros, 2);
  Vec3 place(1, 0, 0);
  double turn = 0;
  for (int frame = 0; frame <= kFrames; ++frame) {
    if (frame > 0) {
      place += 0.25 * Vec3(std::cos(turn), std::sin(turn), 0);
      turn += 0.001 * kMessages;
    }
    const std::string name = (frame % 2 == 0 ? "arm/f" : "f") + std::to_string(frame);
    EXPECT_TRUE(test::eventually([&] { return is_at(client, name, place, 1e-12); }, seconds(10)))
        << name << ros.errors();
  }
  const double used_s = cpu_seconds(ros.pid());
  const nlohmann::json counts = end(ros);
  ASSERT_TRUE(counts.is_object()) << ros.output();
  EXPECT_EQ(counts["transforms"], kFrames * kMessages + 1) << "transforms were lost";
  EXPECT_EQ(counts["objects"], kFrames + 1);
  EXPECT_EQ(counts["missing"], 0);
  EXPECT_EQ(counts["unsent"], 0);
  std::printf("%d frames at 100 Hz: %.2f s of a core in 3 s, %s poses sent\n", kFrames, used_s,
              counts["poses"].dump().c_str());
}

TEST_F(Ros, WhatAFrameTouchesComesBackAsMarkers) {
  start({nothing()});
  Client client = connect();
  add(client, "cart", at(0, 0, 50));
  ASSERT_TRUE(client.add({.name = "wall", .shape = {BoxShape{.half_m = {0.2, 1, 1}}}, .pose = at(1.2, 0, 0)}));
  ChildProcess ros = bridge();
  ChildProcess reader = peer({"contacts"}, "reader");
  ASSERT_TRUE(reader.says("ready", seconds(30))) << reader.errors();
  ChildProcess tf = peer({"into", "20"});
  send(tf, ros);
  ASSERT_TRUE(reader.says("marker contacts 0 type 7 action 0 frame world points 1 (", seconds(20)))
      << reader.output() << reader.errors() << ros.errors();
  EXPECT_TRUE(reader.says("marker depths 1 type 5 action 0 frame world points 2 (", seconds(5))) << reader.output();
  EXPECT_EQ(end(ros)["objects"], 1);
}

TEST_F(Ros, TransformsThatCannotBeMeantAreCountedAndTheRestGoesOn) {
  start({nothing()});
  Client client = connect();
  for (const char* name : {"good", "e", "g"}) add(client, name, at(0, 0, 50));
  ChildProcess ros = bridge();
  ChildProcess tf = peer({"odd"});
  send(tf, ros);
  EXPECT_TRUE(test::eventually([&] { return is_at(client, "good", {3, 0, 0}, 0); }, seconds(10))) << ros.errors();
  EXPECT_TRUE(test::eventually([&] { return is_at(client, "e", {1, 0, 0}, 0); }, seconds(10)));
  EXPECT_TRUE(test::eventually([&] { return is_at(client, "g", {2, 0, 0}, 0); }, seconds(10)));
  const nlohmann::json counts = end(ros);
  EXPECT_EQ(counts["transforms"], 12);
  EXPECT_EQ(counts["unnamed"], 2);
  EXPECT_EQ(counts["bad"], 2);
  EXPECT_EQ(counts["loops"], 1);
  EXPECT_EQ(counts["late"], 1);
  EXPECT_EQ(counts["unstamped"], 1);
  EXPECT_EQ(counts["ahead"], 1);
}

TEST_F(Ros, JointsOfADescribedRobotMoveItsLinks) {
  start({nothing()});
  Client client = connect();
  add(client, "arm/hand", at(0, 0, 50));
  ChildProcess ros = bridge({"--joint-states"});
  ChildProcess states = peer({"joints"});
  send(states, ros);
  EXPECT_TRUE(test::eventually(
      [&] {
        return is_at(client, "arm/hand", {2, 0, 0.5}, 1e-15);
      },
      seconds(10)))
      << ros.errors();
  EXPECT_EQ(end(ros)["joints"], 0);
}

TEST_F(Ros, ATopicOfPosesMovesTheFrameThatItIsGiven) {
  start({nothing()});
  Client client = connect();
  add(client, "crate", at(0, 0, 50));
  ChildProcess ros = bridge({"--pose", "/tracker/pose=crate"});
  ChildProcess poses = peer({"pose"});
  send(poses, ros, 2);
  EXPECT_TRUE(test::eventually([&] { return is_at(client, "crate", {1, 0, 1}, 1e-15); }, seconds(10))) << ros.errors();
  EXPECT_EQ(end(ros)["objects"], 1);
}

TEST_F(Ros, WhatStandsStillIsToldAndADomainThatIsNoneRefused) {
  start({nothing()});
  Client client = connect();
  ASSERT_TRUE(client.add({.name = "good", .shape = {SphereShape{.radius_m = 0.1}}, .moving = false}));
  ChildProcess ros = bridge();
  ChildProcess tf = peer({"odd"});
  send(tf, ros);
  EXPECT_TRUE(test::eventually(
      [&] { return ros.errors().find("standing still; load their scene with --moving") != std::string::npos; },
      seconds(10)))
      << ros.errors();
  EXPECT_EQ(end(ros)["objects"], 0);
  ChildProcess none({COLLIDED_CLI, "ros", "--domain", std::to_string(domain_), "--ros-domain", "231"}, folder_.path(),
                    "none");
  EXPECT_EQ(none.wait(seconds(20)), 2);
  ChildProcess nowhere({COLLIDED_CLI, "ros", "--domain", std::to_string(domain_), "--ros-domain", std::to_string(ros_),
                        "--pose", "/tracker/pose"},
                       folder_.path(), "nowhere");
  EXPECT_EQ(nowhere.wait(seconds(20)), 2);
  EXPECT_NE(nowhere.errors().find("--pose '/tracker/pose'; it is to be TOPIC=FRAME"), std::string::npos);
  EXPECT_NE(none.errors().find("--ros-domain 231, allowed 0 to 230"), std::string::npos) << none.errors();
}

}  // namespace
}  // namespace collided
