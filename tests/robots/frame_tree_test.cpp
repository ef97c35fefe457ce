// Frames of ROS: chains, instants between two, and what cannot be a frame.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "client/ros/frame_tree.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::ros {
namespace {

using Taken = FrameTree::TransformFate;
constexpr std::int64_t kSecondNs = 1'000'000'000;

Pose at(double x, double turn = 0) { return {{x, 0, 0}, Quat(Eigen::AngleAxisd(turn, Vec3::UnitZ()))}; }

TEST(FrameTree, AnInstantBetweenTwoIsInterpolatedAndBeyondThemNothingIsKnown) {
  FrameTree frames;
  EXPECT_EQ(frames.set("world", "a", 10, at(1)), Taken::yes);
  EXPECT_EQ(frames.set("world", "a", 30, at(3, 1)), Taken::yes);
  EXPECT_EQ(frames.set("world", "a", 20, at(5, 0.25)), Taken::yes) << "it comes late, between the others";
  EXPECT_EQ(frames.lookup("world", "a", 10)->position, Vec3(1, 0, 0));
  EXPECT_EQ(frames.lookup("world", "a", 15)->position, Vec3(3, 0, 0));
  EXPECT_NEAR(frames.lookup("world", "a", 25)->rotation.angularDistance(at(0, 0.625).rotation), 0, 1e-15);
  EXPECT_FALSE(frames.lookup("world", "a", 9));
  EXPECT_FALSE(frames.lookup("world", "a", 31)) << "where it went is not known";
  EXPECT_EQ(frames.newest_common("world", "a"), 30);
}

TEST(FrameTree, TheNewestCommonInstantIsThatOfTheSlowestFrameOfTheChain) {
  FrameTree frames;
  frames.set("map", "odom", 5, at(1));
  frames.set("map", "odom", 9, at(1));
  frames.set("odom", "base", 7, at(2));
  frames.set("odom", "base", 8, at(4));
  frames.set("base", "lidar", kAlways, at(0.5));
  EXPECT_EQ(frames.newest_common("map", "lidar"), 8);
  EXPECT_EQ(frames.lookup("map", "lidar", 8)->position, Vec3(5.5, 0, 0));
  EXPECT_EQ(frames.newest_common("odom", "lidar"), 8) << "what is above both does not count";
  EXPECT_EQ(frames.newest_common("base", "lidar"), kAlways);
  EXPECT_EQ(frames.lookup("lidar", "odom", 8)->position, Vec3(-4.5, 0, 0)) << "downwards too";
  frames.set("map", "tag", 8, at(10));
  EXPECT_EQ(frames.lookup("lidar", "tag", 8)->position, Vec3(4.5, 0, 0)) << "and across";
  frames.set("elsewhere", "thing", 8, at(1));
  EXPECT_FALSE(frames.newest_common("map", "thing"));
  EXPECT_FALSE(frames.newest_common("map", "nobody"));
}

TEST(FrameTree, WhatCannotBeAFrameIsToldApartAndChangesNothing) {
  FrameTree frames;
  frames.set("world", "a", 100 * kSecondNs, at(1));
  frames.set("a", "b", 100 * kSecondNs, at(1));
  EXPECT_EQ(frames.set("", "a", 1, at(1)), Taken::unnamed);
  EXPECT_EQ(frames.set("/", "a", 1, at(1)), Taken::unnamed);
  EXPECT_EQ(frames.set("a", "/a", 1, at(1)), Taken::unnamed);
  EXPECT_EQ(frames.set("world", "a", 1, at(std::numeric_limits<double>::infinity())), Taken::bad);
  EXPECT_EQ(frames.set("world", "a", 1, {Vec3::Zero(), Quat(0.5, 0, 0, 0)}), Taken::bad);
  EXPECT_EQ(frames.set("world", "a", 1, {Vec3::Zero(), Quat(0, 0, 0, 0)}), Taken::bad);
  EXPECT_EQ(frames.set("b", "a", 100 * kSecondNs, at(1)), Taken::loop);
  EXPECT_EQ(frames.set("b", "world", 100 * kSecondNs, at(1)), Taken::loop);
  EXPECT_EQ(frames.set("world", "a", 89 * kSecondNs, at(9)), Taken::late);
  EXPECT_EQ(frames.lookup("/world", "b", 100 * kSecondNs)->position, Vec3(2, 0, 0)) << "as before";
  for (std::size_t i = 3; i < FrameTree::kMostFrames; ++i) frames.set("world", "n" + std::to_string(i), 1, at(1));
  EXPECT_EQ(frames.set("world", "more", 1, at(1)), Taken::full);
}

TEST(FrameTree, AnotherParentEndsWhatWasKnown) {
  FrameTree frames;
  frames.set("world", "tool", 10, at(1));
  frames.set("world", "hand", 10, at(5));
  frames.set("hand", "tool", 20, at(0.5));
  frames.set("world", "hand", 20, at(6));
  EXPECT_EQ(frames.lookup("world", "tool", 20)->position, Vec3(6.5, 0, 0));
  EXPECT_FALSE(frames.lookup("world", "tool", 10)) << "then it was elsewhere";
}

// Random trees against products of matrices.
TEST(FrameTree, AnyFrameInAnyOtherIsTheProductAlongTheWay) {
  std::mt19937_64 random = oracle::seeded(20261127);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 200; ++round) {
    FrameTree frames;
    constexpr int kCount = 20;
    std::vector<Eigen::Isometry3d> in_root(kCount, Eigen::Isometry3d::Identity());
    for (int i = 1; i < kCount; ++i) {
      const int parent = static_cast<int>(random() % static_cast<unsigned>(i));
      const Pose pose{{any(random), any(random), any(random)},
                      Quat(any(random), any(random), any(random), 2).normalized()};
      Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
      step.translation() = pose.position;
      step.linear() = pose.rotation.toRotationMatrix();
      in_root[static_cast<std::size_t>(i)] = in_root[static_cast<std::size_t>(parent)] * step;
      ASSERT_EQ(frames.set(std::to_string(parent), std::to_string(i), random() % 2 == 0 ? kAlways : 7, pose),
                Taken::yes);
    }
    const std::size_t a = random() % kCount, b = random() % kCount;
    const Eigen::Isometry3d expected = in_root[a].inverse() * in_root[b];
    const std::optional<Pose> found = frames.lookup(std::to_string(a), std::to_string(b), 7);
    ASSERT_TRUE(found);
    EXPECT_LT((found->position - expected.translation()).norm(), 1e-13);
    EXPECT_LT((found->rotation.toRotationMatrix() - expected.linear()).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace collided::ros
