#include "client/cli/programs/fleet/shard_planning.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided::cli {
namespace {

using nlohmann::json;
using shards::ShardBox;
using shards::ShardMap;

constexpr double kEndless = std::numeric_limits<double>::infinity();
const ShardBox kEverywhere{.low = {-kEndless, -kEndless, -kEndless}, .high = {kEndless, kEndless, kEndless}};

ShardMap whole(double margin_m) { return ShardMap::of(margin_m, {{.name = "whole", .box = kEverywhere}}); }

HeldObject cube(double x, double y, double z, bool moving = true, std::uint64_t triangles = 0) {
  return {.bounds = {.low = {x - 0.5, y - 0.5, z - 0.5}, .high = {x + 0.5, y + 0.5, z + 0.5}},
          .triangles = triangles,
          .moving = moving};
}

TEST(ShardPlan, ARowIsCutInItsMiddle) {
  std::vector<HeldObject> row;
  for (int i = 0; i < 10; ++i) row.push_back(cube(0, 10.0 * i, 0));
  const ShardPlan plan =
      split_shard_box(whole(1), 0, std::vector<std::string>{"left", "right"}, row, LoadMeasure::moving);
  EXPECT_EQ(plan.map.at(0).name, "left");
  EXPECT_EQ(plan.map.at(0).box.high[1], 45) << plan.map.text();
  EXPECT_EQ(plan.loads[0].moving, 5u);
  EXPECT_EQ(plan.loads[1].moving, 5u);
  EXPECT_EQ(plan.objects_in_many, 0u);
}

// Ten stand where the median lies: a plane beside them leaves 11 to 9, one through them 20 on both sides.
TEST(ShardPlan, APlaneKeepsOutOfACrowd) {
  std::vector<HeldObject> objects;
  for (int i = 0; i < 10; ++i) objects.push_back(cube(0, 0.1 * i, 0));
  for (int i = 0; i < 5; ++i) objects.push_back(cube(20.0 + 10 * i, 0, 0));
  for (int i = 0; i < 5; ++i) objects.push_back(cube(-20.0 - 10 * i, 0, 0));
  const ShardPlan plan = split_shard_box(whole(1), 0, std::vector<std::string>{"a", "b"}, objects, LoadMeasure::moving);
  EXPECT_EQ(plan.objects_in_many, 0u) << plan.map.text();
  EXPECT_EQ(std::max(plan.loads[0].moving, plan.loads[1].moving), 15u);
}

TEST(ShardPlan, WhatCountsIsWhatIsAskedFor) {
  const std::vector<HeldObject> objects{cube(0, 0, 0, true), cube(10, 0, 0, true), cube(20, 0, 0, false, 900),
                                        cube(30, 0, 0, false, 900)};
  const std::vector<std::string> names{"a", "b"};
  EXPECT_EQ(split_shard_box(whole(1), 0, names, objects, LoadMeasure::moving).map.at(0).box.high[0], 5);
  EXPECT_EQ(split_shard_box(whole(1), 0, names, objects, LoadMeasure::triangles).map.at(0).box.high[0], 25);
  EXPECT_EQ(split_shard_box(whole(1), 0, names, objects, LoadMeasure::objects).map.at(0).box.high[0], 15);
}

TEST(ShardPlan, WhatCannotBeSplitIsSaid) {
  const std::vector<HeldObject> stack(5, cube(1, 1, 1));
  const std::vector<std::string> names{"a", "b"};
  EXPECT_THROW(split_shard_box(whole(1), 0, names, stack, LoadMeasure::moving), shards::ShardMapError);
  EXPECT_THROW(split_shard_box(whole(1), 0, names, {}, LoadMeasure::moving), shards::ShardMapError);
  const std::vector<HeldObject> endless(3, HeldObject{.bounds = kEverywhere, .moving = true});
  EXPECT_THROW(split_shard_box(whole(1), 0, names, endless, LoadMeasure::moving), shards::ShardMapError);
}

/// The best that any plane at any place between two sides does, tried one by one.
std::uint64_t best_by_trying(const std::vector<HeldObject>& objects, double margin_m) {
  std::uint64_t best = objects.size();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<double> sides;
    for (const HeldObject& object : objects) {
      sides.push_back(object.bounds.low[axis] - margin_m);
      sides.push_back(object.bounds.high[axis] + margin_m);
    }
    std::ranges::sort(sides);
    for (std::size_t i = 0; i + 1 < sides.size(); ++i) {
      const double plane = (sides[i] + sides[i + 1]) / 2;
      std::uint64_t low = 0;
      std::uint64_t high = 0;
      for (const HeldObject& object : objects) {
        low += object.bounds.low[axis] - margin_m <= plane ? 1 : 0;
        high += object.bounds.high[axis] + margin_m >= plane ? 1 : 0;
      }
      best = std::min(best, std::max(low, high));
    }
  }
  return best;
}

TEST(ShardPlan, NoPlaneLeavesLessInWhateverOrderTheObjectsCome) {
  const char* const given = std::getenv("COLLIDED_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : 28;
  for (std::uint64_t round = 0; round < 300; ++round) {
    SCOPED_TRACE("COLLIDED_SEED=" + std::to_string(seed + round));
    std::mt19937_64 random(seed + round);
    std::vector<HeldObject> objects;
    const std::size_t count = 10 + random() % 60;
    std::uniform_real_distribution<double> somewhere(-20, 20);
    while (objects.size() < count) objects.push_back(cube(somewhere(random), somewhere(random), somewhere(random)));
    const std::vector<std::string> names{"a", "b"};
    const ShardPlan plan = split_shard_box(whole(0.5), 0, names, objects, LoadMeasure::moving);
    const std::uint64_t heavier = std::max(plan.loads[0].moving, plan.loads[1].moving);
    ASSERT_EQ(heavier, best_by_trying(objects, 0.5)) << plan.map.text();
    std::ranges::shuffle(objects, random);
    ASSERT_EQ(split_shard_box(whole(0.5), 0, names, objects, LoadMeasure::moving).map.fingerprint(),
              plan.map.fingerprint());
  }
}

class FleetPlanVerb : public testing::Test {
 protected:
  void SetUp() override {
    fake::reset();
    fake::server().command = [](const std::string& name, const json& arguments, const Shape&) -> Result<std::string> {
      EXPECT_EQ(name, "list");
      EXPECT_EQ(arguments.value("bounds", false), true);
      json objects = json::array();
      for (int i = 0; i < 8; ++i) {
        const double x = 10.0 * i;
        objects.push_back({{"name", "ball_" + std::to_string(i)},
                           {"moving", i != 0},
                           {"triangles", 0},
                           {"bounds", {{x - 1, -1, -1}, {x + 1, 1, 1}}}});
      }
      objects.push_back(
          {{"name", "floor"}, {"moving", false}, {"triangles", 2}, {"bounds", {{-9, -9, 0}, {90, 9, 0}}}});
      objects.push_back({{"name", "ground"},
                         {"moving", false},
                         {"triangles", 0},
                         {"bounds", {{nullptr, nullptr, nullptr}, {nullptr, nullptr, 0}}}});
      return json{{"objects", objects}}.dump();
    };
  }
};

TEST_F(FleetPlanVerb, PrintsAMapThatAServerReads) {
  const Ran ran = collide("fleet plan --into 4 --margin 50cm --by objects");
  ASSERT_EQ(ran.code, 0) << ran.err;
  const ShardMap map = ShardMap::parse(ran.out);
  EXPECT_EQ(map.size(), 4u);
  EXPECT_EQ(map.margin_m(), 0.5);
  EXPECT_EQ(ran.err, "objects: s1 4, s2 4, s3 4, s4 4; 2 of 10 objects in more than one shard\n");
  EXPECT_EQ(collide("fleet plan --into 4 --margin 50cm --by objects").out, ran.out);
}

TEST_F(FleetPlanVerb, RefusesWhatIsNotMeant) {
  EXPECT_EQ(collide("fleet plan --into 1").code, 2);
  EXPECT_EQ(collide("fleet plan --into 65").code, 2);
  EXPECT_EQ(collide("fleet plan --by weight").code, 2);
  EXPECT_EQ(collide("fleet plan --split west").code, 2);
  EXPECT_EQ(collide("fleet plan --margin 0").code, 2);
  EXPECT_EQ(collide("fleet --into 4").code, 2);
  EXPECT_EQ(collide("fleet build").code, 2);
  const Ran none = collide("fleet plan --shards no_such_file.json");
  EXPECT_EQ(none.code, 2);
  EXPECT_NE(none.err.find("no_such_file.json: it cannot be opened"), std::string::npos) << none.err;
}

}  // namespace
}  // namespace collided::cli
