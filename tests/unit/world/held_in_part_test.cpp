// A shard's world holds some triangles of a part. What it says of them is true of what lies in its box.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "server/intake/scene.hpp"
#include "server/world/query/query.hpp"
#include "server/world/world.hpp"

namespace collided::engine {
namespace {

/// Of a floor at z = 0 with the triangles 5, 6 and 9 the first two, between x = 0 and 2; the shard's box ends at x = 2.
struct HeldFloor {
  HeldFloor() {
    Scene scene{.name = "yard"};
    scene.mesh.vertices = {{0, -1, 0}, {2, -1, 0}, {2, 1, 0}, {0, 1, 0}};
    scene.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    Part floor{.name = "yard/floor", .triangle_count = 2};
    floor.cut.held = std::make_shared<const std::vector<std::uint32_t>>(std::vector<std::uint32_t>{5, 6});
    floor.cut.whole_count = 10;
    scene.parts = {floor};
    static_cast<void>(world.add_scene(World::index_scene(std::move(scene), {})));
    ObjectDefinition definition;
    definition.name = "ball";
    definition.shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.5});
    definition.pose.position = {1, 0, 3};
    ball = std::get<ObjectId>(world.define(definition));
    step();
  }
  void step() { ASSERT_TRUE(world.step(++seconds * 1'000'000'000, 1, {})); }
  /// Returns why the contact with the floor ended in the step, or none.
  EndReason move_to(const Vec3& position) {
    world.move(ball, {.position = position}, (seconds + 1) * 1'000'000'000, false);
    step();
    EndReason reason = EndReason::none;
    for (const Event& event : world.events()) {
      if (event.kind == EventKind::ended) reason = event.reason;
    }
    return reason;
  }

  World world{WorldOptions{.held = Aabb{.low = Vec3(-10, -10, -10), .high = Vec3(2, 10, 10)}}};
  ObjectId ball = 0;
  std::int64_t seconds = 0;
};

TEST(HeldInPart, AnswersGiveTheNumbersOfTheWholePart) {
  HeldFloor floor;
  QueryScratch scratch;
  Answers answers;
  const std::vector<double> rays{1.5, -0.5, 1, 0, 0, -1, 5, 0.5, 0.5, 1, 0, 0, -1, 5};
  answer(*floor.world.newest(),
         {.kind = QuestionKind::ray, .mode = HitMode::closest, .max_hits = 1'000, .numbers = rays, .mover = nullptr},
         answers, scratch);
  ASSERT_EQ(answers.hits.size(), 2u);
  const ObjectInfo& info = *floor.world.info(answers.hits[0].object);
  EXPECT_EQ(info.reported_triangle(answers.hits[0].triangle), 5u);
  EXPECT_EQ(info.reported_triangle(answers.hits[1].triangle), 6u);
}

TEST(HeldInPart, WhatLiesInTheBoxHasPartedForCertain) {
  HeldFloor floor;
  EXPECT_EQ(floor.move_to({1, 0, 0.3}), EndReason::none);
  ASSERT_EQ(floor.world.contacts().size(), 1u);
  EXPECT_EQ(floor.move_to({1, 0, 3}), EndReason::separated);
}

// Where it reaches beyond, it may touch what another shard holds of the floor: that one says when the contact ends.
TEST(HeldInPart, WhatReachesBeyondTheBoxHasOnlyLeft) {
  HeldFloor floor;
  EXPECT_EQ(floor.move_to({1, 0, 0.3}), EndReason::none);
  EXPECT_EQ(floor.move_to({4, 0, 0.3}), EndReason::removed);
  EXPECT_TRUE(floor.world.contacts().empty());
  EXPECT_EQ(floor.move_to({1, 0, 0.3}), EndReason::none);
  EXPECT_EQ(floor.move_to({1.8, 0, 3}), EndReason::removed) << "at its end it is half outside";
}

}  // namespace
}  // namespace collided::engine
