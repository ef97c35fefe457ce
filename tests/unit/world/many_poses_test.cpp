#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <random>

#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::engine {
namespace {

/// Balls, boxes, bodies of several shapes and of a mesh.
struct Bodies {
  Bodies() {
    const auto mesh = std::make_shared<const TriangleMesh>(scenes::icosphere(1, 0.5));
    for (int i = 0; i < 40; ++i) {
      ObjectDefinition definition;
      definition.name = "body " + std::to_string(i);
      definition.pose.position = {3.0 * i, 0, 0};
      const Sphere ball{.center = {0.1 * (i % 3), 0, 0}, .radius_m = 0.3};
      const Box box{.center = Vec3::Zero(), .axes = Mat3::Identity(), .half_m = {0.2, 0.3, 0.4}};
      if (i % 4 == 0 || i % 4 == 2) definition.shape.primitives.emplace_back(ball);
      if (i % 4 == 1 || i % 4 == 2) definition.shape.primitives.emplace_back(box);
      if (i % 4 == 3) definition.shape.mesh = mesh;
      ids.push_back(std::get<ObjectId>(world.define(definition)));
    }
    world.step(1, 1, {});
  }
  World world{WorldOptions{}};
  std::vector<ObjectId> ids;
};

TEST(WorldManyPoses, LeaveTheSameStateAsOneAfterTheOther) {
  Bodies together;
  Bodies single;
  std::mt19937_64 random = oracle::seeded(31);
  std::uniform_real_distribution<double> place(-20, 20);
  std::normal_distribution<double> turn;
  const ObjectId gone = together.ids[5];
  for (Bodies* bodies : {&together, &single}) bodies->world.remove(gone, EndReason::removed);
  for (int round = 0; round < 5; ++round) {
    std::vector<Pose> poses;
    std::vector<ObjectId> ids = together.ids;
    std::shuffle(ids.begin(), ids.end(), random);
    ids.push_back(0xdeadbeef);
    ids.push_back(0);
    for (std::size_t i = 0; i < ids.size(); ++i) {
      poses.push_back({.position = {place(random), place(random), place(random)},
                       .rotation = Quat(turn(random), turn(random), turn(random), turn(random)).normalized()});
    }
    const auto moved = std::make_unique<bool[]>(ids.size());
    together.world.move(ids, poses, round + 2, round % 2 == 1, {moved.get(), ids.size()});
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const bool there = single.world.move(ids[i], poses[i], round + 2, round % 2 == 1);
      EXPECT_EQ(moved[i], there);
      EXPECT_EQ(there, ids[i] != gone && ids[i] != 0xdeadbeef && ids[i] != 0);
    }
    ASSERT_TRUE(together.world.step(round + 2, 1, {}));
    ASSERT_TRUE(single.world.step(round + 2, 1, {}));
    const auto a = together.world.newest();
    const auto b = single.world.newest();
    for (const ObjectId id : together.ids) {
      const std::uint32_t slot = slot_of(id);
      EXPECT_EQ(std::memcmp(&a->poses[slot], &b->poses[slot], sizeof(Pose)), 0);
      EXPECT_EQ(a->posed_ns[slot], b->posed_ns[slot]);
    }
    EXPECT_EQ(together.world.events().size(), single.world.events().size());
  }
}

// What the fast way over a lone ball's centre gives holds every point of it, as the way over its parts does.
TEST(WorldManyPoses, ABallsBoundsAreThoseOfItsShape) {
  Bodies bodies;
  const Pose pose{.position = {1e6, -3, 0.1}, .rotation = Quat(1, 2, 3, 4).normalized()};
  bool moved = false;
  bodies.world.move(std::span(&bodies.ids[0], 1), std::span(&pose, 1), 2, false, {&moved, 1});
  ASSERT_TRUE(moved);
  ASSERT_TRUE(bodies.world.step(2, 1, {}));
  const std::uint32_t slot = slot_of(bodies.ids[0]);
  const Aabb expected = bounds(place(frame_of(pose), Sphere{.center = Vec3::Zero(), .radius_m = 0.3}));
  EXPECT_EQ(bodies.world.newest()->bounds(slot).low, expected.low);
  EXPECT_EQ(bodies.world.newest()->bounds(slot).high, expected.high);
}

}  // namespace
}  // namespace collided::engine
