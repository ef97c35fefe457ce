// `collide ros` between the server and a program that speaks as ROS 2's rmw_fastrtps does.

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <collided/client.hpp>

#include "tests/interop/big_cloud.hpp"
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
  static constexpr int kBigCloud = 300'000;
  static constexpr double kBigCell_m = 0.10000000149011612;  // 0.1, rounded to 24 bits
  /// Which rays from above do not meet the top of the cell that the large cloud has there, to their bound; every seventh is
  /// asked. At most ten sentences.
  static std::vector<std::string> wrong_in_big_cloud(Client& client) {
    std::vector<RayQuestion> rays;
    std::vector<int> numbers;
    for (int number = 0; number < kBigCloud; number += 7) {
      const std::array<float, 3> point = interop::big_cloud_point(number);
      rays.push_back({.origin = {point[0], point[1], 5}, .direction = {0, 0, -1}});
      numbers.push_back(number);
    }
    const Result<Answers> answers = client.ask(rays, {.timeout = seconds(60)});
    if (!answers) return {answers.error().message};
    std::vector<std::string> wrong;
    for (std::size_t i = 0; i < rays.size() && wrong.size() < 10; ++i) {
      const Answer& answer = answers->answers[i];
      const double wanted_m = 5 - kBigCell_m * (numbers[i] * 7 % 13 + 1);
      const bool is_right = answer.verdict == Verdict::hit &&
                            std::abs(answer.hits.at(0).distance_m - wanted_m) <= answer.hits.at(0).error_m;
      if (!is_right) {
        wrong.push_back("point " + std::to_string(numbers[i]) + ": verdict " +
                        std::to_string(static_cast<int>(answer.verdict)) + ", wanted is a hit at " +
                        std::to_string(wanted_m));
      }
    }
    return wrong;
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
  send(states, ros, 3);
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

TEST_F(Ros, CloudsOfAnyLayoutBecomeCellsAndOthersAreCounted) {
  start({nothing()});
  Client client = connect();
  ChildProcess ros = bridge({"--cloud", "/points=scan", "--voxels", "0.5", "--unknown", "undecided", "--decay", "60s"});
  ChildProcess points = peer({"clouds"});
  send(points, ros, 2);
  const auto is_hit = [&](const Vec3& from, const Vec3& along, double distance_m) {
    const Result<Answer> answer = client.ask(RayQuestion{.origin = from, .direction = along});
    return answer && answer->verdict == Verdict::hit && std::abs(answer->hits.at(0).distance_m - distance_m) <= 1e-9;
  };
  // The sensor stands at 10 0 0; its ways to the points are free, and all else is unknown.
  EXPECT_TRUE(test::eventually(
      [&] {
        return is_hit({10.25, 0.25, 0.25}, {1, 0, 0}, 1.75);
      },
      seconds(10)))
      << ros.errors();
  EXPECT_TRUE(test::eventually(
      [&] {
        return is_hit({10.25, 0.25, 0.25}, {0, 1, 0}, 3.75);
      },
      seconds(10)))
      << "numbers of 16 bits, the high byte first";
  EXPECT_TRUE(test::eventually(
      [&] {
        return is_hit({10.25, 0.25, 0.25}, {0, 0, 1}, 4.75);
      },
      seconds(10)))
      << "stamped an hour ahead";
  const Result<Answer> behind = client.ask(RayQuestion{.origin = {10.25, 0.25, 0.25}, .direction = {-1, 0, 0}});
  ASSERT_TRUE(behind) << behind.error().message;
  EXPECT_EQ(behind->verdict, Verdict::undecided);
  EXPECT_EQ(behind->reason, UndecidedReason::not_covered);
  const auto is_told = [&](const char* text) { return ros.errors().find(text) != std::string::npos; };
  EXPECT_TRUE(test::eventually([&] { return is_told("no field z"); }, seconds(5))) << ros.errors();
  EXPECT_TRUE(is_told("field x has datatype 9, known are 1 to 8")) << ros.errors();
  EXPECT_TRUE(is_told("3 bytes of data, 18 are needed")) << ros.errors();
  std::this_thread::sleep_for(std::chrono::milliseconds(1'200));  // until what waits for its frame is given up
  const nlohmann::json counts = end(ros);
  EXPECT_EQ(counts["clouds"], 4);
  EXPECT_EQ(counts["points"], 4);
  EXPECT_EQ(counts["occupied"], 4);
  EXPECT_EQ(counts["bad"], 3);
  EXPECT_EQ(counts["unnamed"], 1);
  EXPECT_EQ(counts["frameless"], 1);
  EXPECT_EQ(counts["unstamped"], 1);
  EXPECT_EQ(counts["ahead"], 1);
  EXPECT_EQ(counts["not_finite"], 1);
}

TEST_F(Ros, ALargeCloudArrivesWholeAndIsAnsweredExactly) {
  start({nothing()});
  Client client = connect();
  ChildProcess ros = bridge({"--cloud", "/points=scan", "--voxels", "0.1"});
  ChildProcess points = peer({"big_cloud", std::to_string(kBigCloud)});
  send(points, ros);
  std::vector<std::string> wrong;
  const auto is_there = [&] { return (wrong = wrong_in_big_cloud(client)).empty(); };
  EXPECT_TRUE(test::eventually(is_there, seconds(60))) << (wrong.empty() ? "" : wrong.front()) << ros.errors();
  const nlohmann::json counts = end(ros);
  EXPECT_GE(counts["clouds"], 1);
  EXPECT_EQ(counts["points"], kBigCloud * counts["clouds"].get<int>()) << "a cloud that came in part";
  EXPECT_EQ(counts["occupied"], kBigCloud);
  EXPECT_EQ(counts["dropped"], 0);
}

TEST_F(Ros, ALargeScanOfAFileIsAnsweredExactly) {
  start({nothing()});
  Client client = connect();
  std::string file = "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " +
                     std::to_string(kBigCloud) + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " +
                     std::to_string(kBigCloud) + "\nDATA binary\n";
  for (int number = 0; number < kBigCloud; ++number) {
    const std::array<float, 3> point = interop::big_cloud_point(number);
    file.append(reinterpret_cast<const char*>(point.data()), sizeof point);
  }
  ASSERT_EQ(::setenv("COLLIDED_FILES", COLLIDED_FILES_BUILT, 1), 0);  // it is not beside `collide` where both are built
  ChildProcess published({COLLIDED_CLI, "publish", folder_.write("scan.pcd", file), "--voxels", "0.1", "--domain",
                          std::to_string(domain_), "--for", "120s"},
                         folder_.path(), "publish");
  std::vector<std::string> wrong;
  const auto is_there = [&] { return (wrong = wrong_in_big_cloud(client)).empty(); };
  EXPECT_TRUE(test::eventually(is_there, seconds(60))) << (wrong.empty() ? "" : wrong.front()) << published.errors();
}

TEST_F(Ros, AMapsCellsAreObstaclesAndADamagedMapChangesNothing) {
  start({nothing()});
  Client client = connect();
  ChildProcess ros = bridge({"--octomap", "/map=map", "--unknown", "undecided"});
  ChildProcess maps = peer({"octomap"});
  send(maps, ros);
  const auto state = [&](const Vec3& at) {
    const Result<Answer> answer = client.ask(SphereQuestion{.center = at, .radius_m = 0.1});
    return answer ? answer->verdict : Verdict::invalid;
  };
  EXPECT_TRUE(test::eventually([&] { return state({0.25, 0.25, 0.25}) == Verdict::hit; }, seconds(10))) << ros.errors();
  EXPECT_TRUE(test::eventually([&] { return state({0.75, 0.25, 0.25}) == Verdict::miss; }, seconds(5)));
  EXPECT_EQ(state({1.25, 0.25, 0.25}), Verdict::undecided);
  for (const char* wrong : {"a tree of kind 'ColorOcTree', known is OcTree", "the tree breaks off at byte"}) {
    EXPECT_TRUE(test::eventually([&] { return ros.errors().find(wrong) != std::string::npos; }, seconds(5)))
        << wrong << " is not in:\n"
        << ros.errors();
  }
  const nlohmann::json counts = end(ros);
  EXPECT_EQ(counts["maps"], 1);
  EXPECT_EQ(counts["bad"], 2);
}

TEST_F(Ros, MarkersAreObjectsWhereTheirFrameIs) {
  start({nothing()});
  Client client = connect();
  ChildProcess ros = bridge({"--markers", "/things"});
  ChildProcess things = peer({"markers"});
  send(things, ros, 2);
  EXPECT_TRUE(test::eventually(
      [&] {
        return is_at(client, "things/things/1", {11, 0, 0}, 0);
      },
      seconds(10)))
      << ros.errors();
  EXPECT_TRUE(is_at(client, "things/things/2", {12, 0, 0}, 0));
  EXPECT_TRUE(is_at(client, "things/things/3", {20, 0, 0}, 0));
  EXPECT_TRUE(is_at(client, "things/things/4", {40, 0, 0}, 0));
  EXPECT_TRUE(test::eventually([&] { return !client.get("things/things/10"); }, seconds(5))) << "it was deleted";
  const Result<Answer> ray = client.ask(RayQuestion{.origin = {11, 0, 5}, .direction = {0, 0, -1}});
  ASSERT_TRUE(ray && !ray->hits.empty());
  EXPECT_EQ(ray->hits.at(0).distance_m, 4.75) << "a cube of half a metre";
  std::this_thread::sleep_for(std::chrono::milliseconds(1'200));  // until what waits for its frame is given up
  const nlohmann::json counts = end(ros);
  EXPECT_EQ(counts["marker_objects"], 4);
  EXPECT_EQ(counts["shapeless"], 2);
  EXPECT_EQ(counts["unnamed"], 1);
  EXPECT_EQ(counts["bad"], 1);
  EXPECT_EQ(counts["frameless"], 1);
  EXPECT_EQ(counts["unstamped"], 1);
  EXPECT_EQ(counts["ahead"], 1);
  EXPECT_NE(ros.errors().find("unknown type 99"), std::string::npos) << ros.errors();
}

TEST_F(Ros, TheWorldGoesOutAsObjectsTransformsContactsClearanceAndDiagnostics) {
  start({nothing()});
  Client client = connect();
  ASSERT_TRUE(client.add({.name = "ball", .shape = {SphereShape{.radius_m = 0.5}}, .pose = at(3, 0, 0)}));
  ASSERT_TRUE(
      client.add({.name = "wall", .shape = {BoxShape{.half_m = {0.5, 1, 1}}}, .pose = at(5, 0, 0), .moving = false}));
  ChildProcess ros = bridge({"--clearance-of", "ball", "--objects", "--tf"});
  ChildProcess reader = peer({"outputs"});
  ASSERT_TRUE(reader.says("ready", seconds(30))) << reader.errors() << ros.errors();
  EXPECT_TRUE(reader.says("clearance 1\n", seconds(10))) << reader.output() << ros.errors();
  EXPECT_TRUE(reader.says("object ball type 2 at 3", seconds(10))) << reader.output();
  EXPECT_TRUE(reader.says("object wall type 1 at 5", seconds(10))) << reader.output();
  EXPECT_TRUE(reader.says("transform world to ball at 3", seconds(10))) << reader.output();
  EXPECT_TRUE(reader.says("diagnostic 0 collided: server: ready", seconds(10))) << reader.output();
  ASSERT_TRUE(client.move("ball", at(4.25, 0, 0)));
  EXPECT_TRUE(reader.says("contact ball wall depth 0.25", seconds(10))) << reader.output();
  EXPECT_TRUE(reader.says("clearance -0.25", seconds(10))) << reader.output();
  EXPECT_TRUE(reader.says("diagnostic 0 collided: clearance of ball: touching", seconds(10))) << reader.output();
  EXPECT_EQ(end(ros)["objects"], 0) << "what was sent here does not come back as a frame to follow";
}

/// What a program prints, as far as its lines are whole, a JSON value from each.
std::vector<nlohmann::json> json_lines(const std::string& text) {
  std::vector<nlohmann::json> lines;
  std::istringstream from(text);
  for (std::string line; std::getline(from, line);) lines.push_back(nlohmann::json::parse(line, nullptr, false));
  return lines;
}

// What dashboards make of the bytes on the wire: every member read, none left over, and the numbers those of the server.
TEST_F(Ros, WhatGoesOutIsReadByFoxglovesReader) {
#ifndef COLLIDED_NODE
  GTEST_SKIP() << "skipped: no node";
#else
  start({nothing()});
  Client client = connect();
  const Quat turn(Eigen::AngleAxisd(0.3, Vec3(1, 2, 3).normalized()));
  const Pose pose{.position = {4.3, 0.1, -0.2}, .rotation = turn};
  ASSERT_TRUE(client.add({.name = "ball", .shape = {SphereShape{.radius_m = 0.5}}, .pose = at(0, 0, 0)}));
  ASSERT_TRUE(
      client.add({.name = "wall", .shape = {BoxShape{.half_m = {0.5, 1, 1}}}, .pose = at(5, 0, 0), .moving = false}));
  ChildProcess ros = bridge({"--clearance-of", "b*", "--objects", "--tf"});
  ChildProcess reader = peer({"raw"});
  ASSERT_TRUE(reader.says("ready", seconds(30))) << reader.errors() << ros.errors();
  ASSERT_TRUE(client.move("ball", pose));
  const Result<ObjectDetails> ball_there = client.get("ball");
  ASSERT_TRUE(ball_there && ball_there->pose);
  const Quat turned = ball_there->pose->rotation;  // as the server has it: of length 1 to the last bit
  const Result<PairAnswer> pair = client.pair("ball", "wall");
  ASSERT_TRUE(pair && pair->verdict == Verdict::hit);
  std::vector<nlohmann::json> messages;
  const auto find = [&](const std::string& type, auto&& fits) {
    for (const nlohmann::json& one : messages)
      if (one["type"] == type && fits(one["message"])) return one["message"];
    return nlohmann::json();
  };
  const auto is_of_contact = [](const nlohmann::json& m) { return !m["contacts"].empty(); };
  const auto is_moved = [&](const nlohmann::json& m) {
    for (const nlohmann::json& one : m["transforms"])
      if (one["transform"]["translation"]["x"] == pose.position.x()) return true;
    return false;
  };
  const auto marker_of = [](const nlohmann::json& m, const std::string& ns) {
    for (const nlohmann::json& one : m["markers"])
      if (one["ns"] == ns) return one;
    return nlohmann::json();
  };
  const auto is_shown = [&](const nlohmann::json& m) {
    const nlohmann::json one = marker_of(m, "ball");
    return !one.is_null() && one["pose"]["position"]["x"] == pose.position.x();
  };
  const auto is_drawn = [&](const nlohmann::json& m) {
    const nlohmann::json one = marker_of(m, "depths");
    return !one.is_null() && one["points"].size() == 2;
  };
  const auto is_deep = [&](const nlohmann::json& m) { return m["data"] == -pair->depth_m; };
  const auto is_of_server = [](const nlohmann::json& m) { return m["status"].size() >= 2; };
  int tries = 0;
  // Reads all that has come so far; returns the reader's exit code.
  const auto read_all = [&] {
    const std::string said = reader.output();
    const std::string file = folder_.write("raw.txt", said.substr(0, said.rfind('\n') + 1));
    ChildProcess read({COLLIDED_NODE, COLLIDED_FOXGLOVE_READER, "--modules", COLLIDED_NODE_MODULES, file},
                      folder_.path(), "read" + std::to_string(++tries));
    const int code = read.wait(seconds(20));
    EXPECT_TRUE(code == 0 || code == 77) << read.errors();
    messages = code == 0 ? json_lines(read.output()) : std::vector<nlohmann::json>();
    return code;
  };
  const auto has_all = [&] {
    return read_all() != 0 || (!find("ros_gz_interfaces/Contacts", is_of_contact).is_null() &&
                               !find("tf2_msgs/TFMessage", is_moved).is_null() &&
                               !find("visualization_msgs/MarkerArray", is_shown).is_null() &&
                               !find("visualization_msgs/MarkerArray", is_drawn).is_null() &&
                               !find("std_msgs/Float64", is_deep).is_null() &&
                               !find("diagnostic_msgs/DiagnosticArray", is_of_server).is_null());
  };
  ASSERT_TRUE(test::eventually(has_all, seconds(20))) << reader.output().size() << " bytes\n" << ros.errors();
  if (messages.empty()) GTEST_SKIP() << "skipped: no npm packages of Foxglove; deploy/install --tests BUILD";
  for (const nlohmann::json& one : messages) {
    EXPECT_TRUE(one["is_whole"]) << one;
    EXPECT_TRUE(one["is_same"]) << one;
  }
  const auto vector = [](const nlohmann::json& v) {
    return Vec3(v["x"].get<double>(), v["y"].get<double>(), v["z"].get<double>());
  };
  const auto rotation = [](const nlohmann::json& q) {
    return Quat(q["w"].get<double>(), q["x"].get<double>(), q["y"].get<double>(), q["z"].get<double>());
  };
  const nlohmann::json ball = marker_of(find("visualization_msgs/MarkerArray", is_shown), "ball");
  EXPECT_EQ(ball["type"], 2);
  EXPECT_EQ(ball["header"]["frame_id"], "world");
  EXPECT_EQ(vector(ball["pose"]["position"]), pose.position);
  // A marker's orientation is a product of the object's and the shape's own, and rounded once more.
  EXPECT_LE((rotation(ball["pose"]["orientation"]).coeffs() - turned.coeffs()).cwiseAbs().maxCoeff(), 4e-16);
  EXPECT_EQ(vector(ball["scale"]), Vec3(1, 1, 1));
  EXPECT_EQ(ball["mesh_file"]["filename"], "");
  const nlohmann::json wall = marker_of(find("visualization_msgs/MarkerArray", is_shown), "wall");
  EXPECT_EQ(vector(wall["scale"]), Vec3(1, 2, 2));
  for (const nlohmann::json& moved : find("tf2_msgs/TFMessage", is_moved)["transforms"]) {
    if (moved["transform"]["translation"]["x"] != pose.position.x()) continue;
    EXPECT_EQ(moved["child_frame_id"], "ball");
    EXPECT_EQ(vector(moved["transform"]["translation"]), pose.position);
    EXPECT_EQ(rotation(moved["transform"]["rotation"]).coeffs(), turned.coeffs());
  }
  const nlohmann::json contact = find("ros_gz_interfaces/Contacts", is_of_contact)["contacts"][0];
  EXPECT_EQ((std::set<std::string>{contact["collision1"]["name"], contact["collision2"]["name"]}),
            (std::set<std::string>{"ball", "wall"}));
  EXPECT_EQ(contact["depths"].size(), 1U);
  EXPECT_NEAR(contact["depths"][0].get<double>(), pair->depth_m, pair->error_m + 1e-12);
  const nlohmann::json lines = marker_of(find("visualization_msgs/MarkerArray", is_drawn), "depths");
  EXPECT_EQ(vector(lines["points"][0]), vector(contact["positions"][0]));
  EXPECT_NEAR((vector(lines["points"][1]) - vector(lines["points"][0])).norm(), pair->depth_m, 1e-9);
  const nlohmann::json diagnostics = find("diagnostic_msgs/DiagnosticArray", is_of_server)["status"];
  EXPECT_EQ(diagnostics[0]["name"], "collided: server");
  EXPECT_EQ(diagnostics[0]["message"], "ready");
  EXPECT_EQ(diagnostics[0]["level"], 0);
  // Other letters are only read: written again they are too few bytes, since that package counts letters.
  ASSERT_TRUE(client.add({.name = "k\u00e4fig", .shape = {SphereShape{.radius_m = 0.5}}, .pose = at(0, 0, 0)}));
  EXPECT_TRUE(test::eventually(
      [&] {
        return read_all() == 0 && !find("visualization_msgs/MarkerArray", [&](const nlohmann::json& m) {
                                     return !marker_of(m, "k\u00e4fig").is_null();
                                   }).is_null();
      },
      seconds(20)));
#endif
}

TEST_F(Ros, SimulatedTimeIsThatOfTheClock) {
  start({nothing()});
  Client client = connect();
  add(client, "cart", at(0, 0, 50));
  ChildProcess ros = bridge({"--sim-time"});
  ChildProcess clock = peer({"clock"});
  send(clock, ros, 2);
  EXPECT_TRUE(test::eventually([&] { return is_at(client, "cart", {1, 0, 0}, 1e-12); }, seconds(10))) << ros.errors();
  const nlohmann::json counts = end(ros);
  EXPECT_EQ(counts["ahead"], 0) << "six seconds after the start of the simulation";
  EXPECT_EQ(counts["unstamped"], 0);
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
