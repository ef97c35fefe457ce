#include "server/world/step/placed_boxes.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/geometry/placing_error.hpp"

namespace collided {
namespace {
using namespace engine;

const Box kBox{.center = Vec3(0.1, 0.2, 0.3), .half_m = Vec3(1, 2, 3)};

Pose pose_at(double x, double turn) {
  return {.position = Vec3(x, 0.7, -0.3), .rotation = Quat(1, turn, 0.2, 0).normalized()};
}

std::uint32_t add(ObjectRows& rows, const Primitive& shape, const Pose& pose) {
  auto info = std::make_shared<ObjectInfo>();
  info->id = rows.take_slot();
  info->name = std::to_string(info->id);
  info->primitives = {shape};
  info->moving = true;
  rows.put(info, pose, 0, 0);
  return slot_of(info->id);
}

void expect_placed(const PlacedBox& placed, const Frame& before, const Frame& now) {
  const auto expect_same = [](const Box& one, const Box& other) {
    EXPECT_EQ(one.center, other.center);
    EXPECT_EQ(one.axes, other.axes);
    EXPECT_EQ(one.half_m, other.half_m);
  };
  expect_same(placed.motion.at_end, place(now, kBox));
  expect_same(placed.motion.at_start, place(before, kBox));
  EXPECT_EQ(placed.motion.travel, now.position - before.position);
  EXPECT_EQ(placed.placing_error_m, placing_error_m(now, Primitive(kBox)));
  EXPECT_GT(placed.placing_error_m, 0);
}

class PlacedBoxesTest : public ::testing::Test {
 protected:
  void move(std::uint32_t slot, const Pose& pose, Motion how) {
    rows_.end_step();
    ASSERT_TRUE(rows_.move(rows_.info(slot)->id, pose, {.time_ns = ++time_ns_, .since_ns = time_ns_ - 1}, how));
    boxes_.begin_step(rows_.size());
  }

  ObjectRows rows_;
  PlacedBoxes boxes_;
  std::int64_t time_ns_ = 1;
};

// What a step remembers of the last one would be a contact where there is none.
TEST_F(PlacedBoxesTest, EachStepHasTheBoxesWhereItsPosesPutThem) {
  const std::uint32_t first = add(rows_, kBox, pose_at(0, 0.1));
  const std::uint32_t second = add(rows_, kBox, pose_at(5, 0.3));
  boxes_.begin_step(rows_.size());
  PlacedBoxPair pair = boxes_.pair(rows_, first, second);
  ASSERT_TRUE(pair.are_boxes());
  expect_placed(*pair.a, frame_of(pose_at(0, 0.1)), frame_of(pose_at(0, 0.1)));
  expect_placed(*pair.b, frame_of(pose_at(5, 0.3)), frame_of(pose_at(5, 0.3)));

  move(first, pose_at(1, 0.2), Motion::moved);
  pair = boxes_.pair(rows_, second, first);
  expect_placed(*pair.a, frame_of(pose_at(5, 0.3)), frame_of(pose_at(5, 0.3)));
  expect_placed(*pair.b, frame_of(pose_at(0, 0.1)), frame_of(pose_at(1, 0.2)));

  // Nothing lies between where it was and where it was placed.
  move(first, pose_at(9, 0.4), Motion::placed);
  pair = boxes_.pair(rows_, first, second);
  expect_placed(*pair.a, frame_of(pose_at(9, 0.4)), frame_of(pose_at(9, 0.4)));
}

// The list grows while pairs are asked for, and begins anew where it is full.
TEST_F(PlacedBoxesTest, BothOfAPairAreThereHoweverManyCameBefore) {
  std::vector<std::uint32_t> slots;
  for (std::size_t i = 0; i < PlacedBoxes::kMost + 100; ++i)
    slots.push_back(add(rows_, kBox, pose_at(static_cast<double>(i), 0.1)));
  boxes_.begin_step(rows_.size());
  for (std::size_t i = 0; i + 1 < slots.size(); ++i) {
    const PlacedBoxPair pair = boxes_.pair(rows_, slots[i + 1], slots[i]);
    ASSERT_TRUE(pair.are_boxes());
    EXPECT_EQ(pair.a->motion.at_end.center, place(rows_[slots[i + 1]].frame(), kBox.center));
    EXPECT_EQ(pair.b->motion.at_end.center, place(rows_[slots[i]].frame(), kBox.center));
  }
}

TEST_F(PlacedBoxesTest, WhatIsNoBoxMakesNoPair) {
  const std::uint32_t box = add(rows_, kBox, pose_at(0, 0.1));
  const std::uint32_t ball = add(rows_, Sphere{.center = Vec3::Zero(), .radius_m = 1}, pose_at(1, 0.1));
  boxes_.begin_step(rows_.size());
  EXPECT_FALSE(boxes_.pair(rows_, box, ball).are_boxes());
  EXPECT_FALSE(boxes_.pair(rows_, ball, box).are_boxes());
  EXPECT_TRUE(boxes_.pair(rows_, box, box).are_boxes());
}

}  // namespace
}  // namespace collided
