#pragma once

#include "server/service/ingest/publishers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace collided::engine::service {

using wire_contract::PublisherState;

inline constexpr std::uint64_t kPublisher = 7;

/// A world with a floor at z = 0 and publishers around it, without DDS.
class PublishersTest : public ::testing::Test {
 protected:
  void SetUp() override {
    Scene scene{.name = "room"};
    scene.mesh.vertices = {{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}};
    scene.mesh.triangles = {{0, 1, 2}};
    scene.parts = {{.name = "room/floor", .first_triangle = 0, .triangle_count = 1, .filter = {}}};
    const auto indexed = World::index_scene(scene, {});
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(indexed)));
    step();
  }
  static DefinitionSample definition(std::uint32_t number, std::uint64_t sequence, const std::string& name,
                                     double z = 3) {
    DefinitionSample sample;
    sample.publisher = kPublisher;
    sample.object_number = number;
    sample.incarnation = 1;
    sample.sequence = sequence;
    sample.name = name;
    sample.publisher_name = "test";
    sample.pose = {0, 0, z, 1, 0, 0, 0};
    Shape ball;
    ball.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.5});
    sample.shape = ball;
    return sample;
  }
  static DefinitionSample removal(std::uint32_t number, std::uint64_t sequence) {
    DefinitionSample sample = definition(number, sequence, "");
    sample.removed = true;
    return sample;
  }
  static PoseSample pose(std::uint64_t sequence, const std::vector<std::pair<std::uint32_t, double>>& heights,
                         std::uint64_t through = 0) {
    PoseSample sample;
    sample.publisher = kPublisher;
    sample.incarnation = 1;
    sample.sequence = sequence;
    sample.definitions_through = through;
    for (const auto& [number, z] : heights) {
      sample.object_numbers.push_back(number);
      sample.poses.insert(sample.poses.end(), {0, 0, z, 1, 0, 0, 0});
    }
    return sample;
  }
  void step() {
    ASSERT_TRUE(world.step(++now_ns, 1, {}));
    publishers.stepped();
    for (const Event& event : world.events()) events.push_back(event);
  }
  void define(DefinitionSample sample) {
    while (publishers.define(sample, now_ns) == Applied::step_first) step();
    while (publishers.release_parked(now_ns) == Applied::step_first) step();
  }
  void move(PoseSample sample) {
    sample.received_ns = ++now_ns;
    while (publishers.move(sample, now_ns) == Applied::step_first) step();
  }
  void lose() {
    for (const WriterKind kind : {WriterKind::object, WriterKind::pose}) {
      while (publishers.writer_lost(kPublisher, kind, now_ns) == Applied::step_first) step();
    }
  }
  double height(const std::string& name) {
    const std::optional<ObjectId> id = world.find(name);
    return id ? world.newest()->poses[slot_of(*id)].position.z() : std::numeric_limits<double>::quiet_NaN();
  }

  World world{WorldOptions{}};
  Publishers publishers{world, kLimits};
  static constexpr PublisherLimits kLimits{
      .publishers = 3, .object_numbers = 20, .parked_batches = 2, .forget_after_ns = 0};
  std::int64_t now_ns = 1'000;
  std::vector<Event> events;
};

}  // namespace collided::engine::service
