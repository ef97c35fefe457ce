// `collide publish ROBOT.urdf --joints TABLE`.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

constexpr const char* kArm = R"(<robot name="arm"><link name="base"/><link name="upper"/><link name="hand"/>
<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><origin xyz="0 0 1"/>
  <axis xyz="0 1 0"/><limit lower="-2" upper="2"/></joint>
<joint name="slide" type="prismatic"><parent link="upper"/><child link="hand"/><axis xyz="0 0 1"/>
  <limit lower="0" upper="0.5"/></joint></robot>)";

class PublishRobot : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().command = [this](const std::string& name, const nlohmann::json& arguments,
                                    const Shape&) -> Result<std::string> {
      if (name == "load") {
        loaded_ = arguments;
        return std::string(R"({"scene":"arm","triangles":0,"parts":0,"objects":2,"seconds":0,"placed":[],"notes":[],
          "mended":[],"refused":[],"warnings":[],"left_out":[],"covers":[],"version":1})");
      }
      nlohmann::json objects = nlohmann::json::array();
      for (const char* link : {"base", "hand"}) {
        if (loaded_.is_null() && !is_there_) break;
        objects.push_back({{"name", scene_ + "/" + link},
                           {"id", 1},
                           {"kind", "box"},
                           {"moving", true},
                           {"scene", scene_},
                           {"publisher", ""},
                           {"position", {0, 0, 0}},
                           {"triangles", 0},
                           {"layers", 1},
                           {"stale", false}});
      }
      const std::size_t count = objects.size();
      return nlohmann::json{{"objects", objects}, {"count", count}, {"version", 1}}.dump();
    };
  }
  Ran publish(const std::string& table, const std::string& more = "") {
    const ScratchFile robot("arm.urdf", kArm), joints("joints.csv", table);
    return collide("publish " + robot.path() + " --joints " + joints.path() +
                   " --json --fields frames,refused,objects " + more);
  }
  static const fake::Published& published() { return fake::server().publishers.at(0); }

  bool is_there_ = true;
  std::string scene_ = "arm";
  nlohmann::json loaded_;
};

TEST_F(PublishRobot, ARowMovesEveryLinkThatIsAnObject) {
  const Ran ran = publish("t,slide,shoulder\n0,0.25,0\n0.001,0.5,90deg\n0.002,,-1\n", "--at 1 2 3");
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out, "{\"frames\":3,\"refused\":0,\"objects\":2}\n");
  ASSERT_EQ(published().batches.size(), 3U);
  EXPECT_EQ(published().objects.at(1).name, "arm/base");
  EXPECT_EQ(published().objects.at(2).name, "arm/hand");
  EXPECT_EQ(published().objects.at(2).pose.position, Vec3(1, 2, 4.25)) << "claimed where the first row puts it";
  EXPECT_EQ(published().objects.at(2).lost_policy, LostPolicy::freeze);
  EXPECT_EQ(published().batches[0].at(1).position, Vec3(1, 2, 3));
  EXPECT_EQ(published().batches[0].at(2).position, Vec3(1, 2, 4.25));
  EXPECT_NEAR((published().batches[1].at(2).position - Vec3(1.5, 2, 4)).norm(), 0, 1e-15);
  const Vec3 stays(1 - 0.5 * std::sin(1), 2, 4 + 0.5 * std::cos(1));  // an empty cell: the slide is as it was
  EXPECT_NEAR((published().batches[2].at(2).position - stays).norm(), 0, 1e-15);
  EXPECT_TRUE(loaded_.is_null()) << "it was there";
}

TEST_F(PublishRobot, ARobotThatIsNotThereIsLoadedAsMoving) {
  is_there_ = false;
  scene_ = "left";
  EXPECT_EQ(publish("t,slide\n0,0.25\n", "--name left").code, 0);
  EXPECT_EQ(loaded_.at("moving"), true);
  EXPECT_EQ(loaded_.at("name"), "left");
  EXPECT_TRUE(loaded_.at("path").get<std::string>().ends_with("/arm.urdf"));
  EXPECT_EQ(published().objects.at(2).name, "left/hand");
}

TEST_F(PublishRobot, RowsThatCannotBeMeantAreNamedAndLeftOut) {
  const Ran ran = publish("t,shoulder,slide\n0,0,0\n0.001,nan,0\n0.002,0,0.6\n0.003,90,0\n0.004,0\n0.005,1,0.1\n");
  EXPECT_EQ(ran.code, 6);
  EXPECT_EQ(ran.out, "{\"frames\":2,\"refused\":4,\"objects\":2}\n");
  const auto says = [&](const std::string& text) {
    EXPECT_NE(ran.err.find("joints.csv line " + text + "; this row was not sent\n"), std::string::npos) << ran.err;
  };
  says("3: 'nan' in column shoulder");
  says("4: joint 'slide': 0.6 m is beyond its limits, allowed 0 to 0.5");
  says(
      "5: joint 'shoulder': 90 rad is beyond its limits, allowed -2 to 2 (5157 degrees; if degrees were meant, 1.571 "
      "rad)");
  says("6: 2 cells, 3 are needed");
  EXPECT_EQ(publish("t,slide\n0,0\n0.001,0.6\n", "--beyond-limits").out,
            "{\"frames\":2,\"refused\":0,\"objects\":2}\n");
}

// The hand's arc between two rows is a chord to the server: 90 degrees at a radius of 0.5 m are 0.15 m off.
TEST_F(PublishRobot, SparseRowsAreWarnedOfWithTheirChordError) {
  const auto chord_error = [&](const std::string& table) {
    const ScratchFile robot("arm.urdf", kArm), joints("joints.csv", table);
    const Ran ran = collide("publish " + robot.path() + " --joints " + joints.path() + " --json --fields chord_error");
    EXPECT_EQ(ran.code, 0) << ran.err;
    const bool warns = ran.err.find("link 'hand' leaves its arc by up to") != std::string::npos;
    const double metres = nlohmann::json::parse(ran.out).at("chord_error");
    EXPECT_EQ(warns, metres > 1e-3) << ran.err;
    return metres;
  };
  EXPECT_NEAR(chord_error("t,shoulder,slide\n0,0,0.5\n0.001,90deg,\n"), 0.5 - std::sqrt(0.125), 1e-9);
  EXPECT_NEAR(chord_error("t,shoulder,slide\n0,0,0.5\n0.001,1deg,\n"), 0.5 - 0.5 * std::cos(std::acos(-1) / 360), 1e-9);
  EXPECT_NEAR(chord_error("t,slide\n0,0\n0.001,0.5\n"), 0, 1e-15);
}

TEST_F(PublishRobot, AnUnknownColumnIsRefusedWithTheNearestJoint) {
  const Ran ran = publish("t,sholder\n0,0\n");
  EXPECT_EQ(ran.code, 2);
  EXPECT_NE(ran.err.find("joints.csv line 1: robot 'arm' has no joint 'sholder'; did you mean 'shoulder'?"),
            std::string::npos)
      << ran.err;
  EXPECT_NE(publish("t,slide,slide\n0,0,0\n").err.find("column 'slide' stands twice"), std::string::npos);
  EXPECT_NE(publish("slide\n0\n").err.find("joints.csv has no column t"), std::string::npos);
  EXPECT_EQ(publish("slide\n0\n0.1\n", "--rate 1kHz").out, "{\"frames\":2,\"refused\":0,\"objects\":2}\n");
  EXPECT_NE(publish("t,slide\n").err.find("has no row that can be used"), std::string::npos);
}

TEST_F(PublishRobot, WhatCannotBeClaimedEndsTheRunBeforeAnythingMoves) {
  fake::server().left_out = Error{ErrorCode::refused, "object 'arm/hand' is not in the world: the name is taken", ""};
  const Ran ran = publish("t,slide\n0,0\n");
  EXPECT_EQ(ran.code, 5);
  EXPECT_NE(ran.err.find("error: object 'arm/hand' is not in the world: the name is taken"), std::string::npos);
  EXPECT_TRUE(published().batches.empty());
}

TEST_F(PublishRobot, ARobotNeedsJointsAndJointsARobot) {
  const ScratchFile robot("arm.urdf", kArm), poses("poses.csv", "t,x,y,z\n0,0,0,0\n");
  EXPECT_NE(collide("publish " + robot.path()).err.find("a robot moves by its joints"), std::string::npos);
  EXPECT_NE(collide("publish " + poses.path() + " --at 1 2 3").err.find("--at has no meaning"), std::string::npos);
  EXPECT_NE(collide("publish " + robot.path() + " --joints - --loop").err.find("--loop needs a file"),
            std::string::npos);
  EXPECT_NE(collide("publish /nowhere.urdf --joints -").err.find("/nowhere.urdf: it cannot be read"),
            std::string::npos);
}

TEST_F(PublishRobot, JointsComeThroughAPipe) {
  const ScratchFile robot("arm.urdf", kArm);
  const Ran ran = collide("publish " + robot.path() + " --joints - --json --fields frames",
                          {.in = "shoulder slide\n0 0\n0.5 0.1\n"});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(ran.out, "{\"frames\":2}\n");
}

TEST_F(PublishRobot, ALoopPlacesTheRobotAtTheStart) {
  EXPECT_EQ(publish("t,slide\n0,0\n0.001,0.5\n", "--loop --steps 5").out,
            "{\"frames\":5,\"refused\":0,\"objects\":2}\n");
  EXPECT_EQ(published().batches[2].at(2).position, Vec3(0, 0, 1));
}

}  // namespace
}  // namespace collided
