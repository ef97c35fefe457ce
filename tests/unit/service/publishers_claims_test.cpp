// Objects that a publisher takes over, and gives back.
#include "server/service/ingest/publishers.hpp"

#include <gtest/gtest.h>

#include "tests/unit/service/publishers_fixture.hpp"

namespace collided::engine::service {
namespace {

class PublishersClaimsTest : public PublishersTest {
 protected:
  /// A robot of two links, which share a group.
  void load(bool is_moving = true) {
    Scene scene{.name = "arm"};
    for (const char* name : {"arm/hand", "arm/base"}) {
      SceneObject link{.name = name};
      link.shape.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.25});
      link.pose.position = {0, 0, 5};
      link.filter.group = 3;
      scene.objects.push_back(std::move(link));
    }
    scene.is_moving = is_moving;
    ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(World::index_scene(std::move(scene), {}))));
    step();
  }
  static DefinitionSample claim(std::uint32_t number, std::uint64_t sequence, const std::string& name, double z) {
    DefinitionSample sample = definition(number, sequence, name, z);
    sample.shape = Shape{};
    sample.claims = true;
    return sample;
  }
  const ObjectInfo& info(const std::string& name) { return *world.info(*world.find(name)); }
  std::string why(std::uint64_t publisher = kPublisher) {
    const auto left_out = publishers.left_out(publisher, 10);
    return left_out.empty() ? "" : left_out.front().name + ": " + left_out.front().why;
  }
};

TEST_F(PublishersClaimsTest, AClaimMovesWhatIsThereAndGivesItBackWhereItStands) {
  load();
  define(claim(1, 1, "arm/hand", 3));
  move(pose(2, {{1, 2}}));
  step();
  EXPECT_EQ(height("arm/hand"), 2);
  EXPECT_EQ(height("arm/base"), 5);
  EXPECT_EQ(info("arm/hand").publisher, kPublisher);
  EXPECT_EQ(info("arm/hand").filter.group, 3U);
  EXPECT_EQ(info("arm/hand").rare->scene, "arm");
  EXPECT_EQ(std::get<Sphere>(info("arm/hand").primitives.front()).radius_m, 0.25) << "its shape is its own";
  EXPECT_EQ(why(), "");
  define(removal(1, 3));
  step();
  EXPECT_EQ(height("arm/hand"), 2) << "it stays";
  EXPECT_EQ(info("arm/hand").publisher, 0U);
  EXPECT_EQ(world.remove_scene("arm"), 2U) << "it is still of its scene";
}

TEST_F(PublishersClaimsTest, WhatIsNotThereStandsStillOrIsTakenIsWaitedFor) {
  define(claim(1, 1, "arm/hand", 3));
  EXPECT_EQ(why(), "arm/hand: nothing of that name is in the world, to be claimed");
  load(false);
  publishers.settle(now_ns);
  EXPECT_EQ(why(), "arm/hand: it was added as static; a scene is to be loaded as moving");
  world.remove_scene("arm");
  load();
  publishers.settle(now_ns);
  step();
  EXPECT_EQ(why(), "");
  EXPECT_EQ(height("arm/hand"), 3);
  DefinitionSample second = claim(1, 1, "arm/hand", 9);
  second.publisher = 8;
  define(second);
  EXPECT_EQ(why(8), "arm/hand: the name is taken, by publisher 'test'");
  second = definition(2, 2, "room/floor", 9);
  second.publisher = 8;
  define(second);
  EXPECT_EQ(publishers.left_out(8, 10).size(), 2U);
  EXPECT_EQ(publishers.left_out(8, 10).at(1).why, "the name is taken, by scene 'room'");
  define(claim(5, 4, "room/floor", 1));
  EXPECT_EQ(why(), "room/floor: it is a part of the mesh of scene 'room', which stands still");
}

TEST_F(PublishersClaimsTest, ALostPublisherGivesBackOrKeepsByItsPolicyAndTheNextOneGetsIt) {
  load();
  define(claim(1, 1, "arm/hand", 3));
  DefinitionSample frozen = claim(2, 2, "arm/base", 4);
  frozen.lost_policy = static_cast<std::uint8_t>(LostPolicy::freeze);
  define(frozen);
  move(pose(3, {{1, 2}}));
  step();
  lose();
  step();
  EXPECT_EQ(info("arm/hand").publisher, 0U);
  EXPECT_EQ(height("arm/hand"), 2);
  EXPECT_EQ(info("arm/base").publisher, kPublisher);
  DefinitionSample next = claim(1, 1, "arm/base", 8);
  next.publisher = 9;
  define(next);
  step();
  EXPECT_EQ(info("arm/base").publisher, 9U);
  EXPECT_EQ(height("arm/base"), 8);
  EXPECT_EQ(world.find("arm/base").has_value() && world.find("arm/hand").has_value(), true);
}

TEST_F(PublishersClaimsTest, AReplacedSceneIsClaimedAgainAtTheNewestPose) {
  load();
  define(claim(1, 1, "arm/hand", 3));
  step();
  world.remove_scene("arm");
  step();
  publishers.settle(now_ns);
  EXPECT_EQ(why(), "arm/hand: nothing of that name is in the world, to be claimed");
  move(pose(2, {{1, 7}}));
  load();
  publishers.settle(now_ns);
  step();
  EXPECT_EQ(height("arm/hand"), 7);
  EXPECT_EQ(info("arm/hand").publisher, kPublisher);
}

TEST_F(PublishersClaimsTest, ARefusedDefinitionSaysWhyUntilItIsMended) {
  DefinitionSample bad = definition(1, 1, "ball");
  bad.pose[3] = 2;
  define(bad);
  EXPECT_NE(why(), "");
  define(definition(1, 2, "ball"));
  EXPECT_EQ(why(), "");
}

}  // namespace
}  // namespace collided::engine::service
