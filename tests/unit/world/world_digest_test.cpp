// Two worlds are the same where their digests are, and where they are not the digests say which object differs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "server/world/query/world_digest.hpp"
#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

using Places = std::map<std::string, Vec3>;

void define(World& world, const std::string& name, const Vec3& place, double radius_m = 0.5) {
  ObjectDefinition definition;
  definition.name = name;
  definition.shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = radius_m}};
  definition.pose = {.position = place};
  ASSERT_TRUE(std::holds_alternative<ObjectId>(world.define(definition)));
}

/// Defined in this order, so that ids and slots differ between orders.
void fill(World& world, const Places& places, const std::vector<std::string>& order) {
  for (const std::string& name : order) define(world, name, places.at(name));
  ASSERT_TRUE(world.step(1, 1, {}));
}

std::vector<std::string> names_of(const Places& places) {
  std::vector<std::string> names;
  for (const auto& [name, place] : places) names.push_back(name);
  return names;
}

class Digests : public testing::Test {
 protected:
  Digests() {
    std::uniform_real_distribution<double> metres(-100, 100);
    for (int i = 0; i < 300; ++i)
      places["ball_" + std::to_string(i)] = {metres(random), metres(random), metres(random)};
  }

  std::mt19937_64 random = oracle::seeded(28);
  Places places;
};

TEST_F(Digests, OrderAndIdsDoNotShow) {
  World here{WorldOptions{}};
  World there{WorldOptions{}};
  std::vector<std::string> names = names_of(places);
  fill(here, places, names);
  std::shuffle(names.begin(), names.end(), random);
  define(there, "in the way", {1, 2, 3});
  ASSERT_TRUE(there.step(1, 1, {}));
  fill(there, places, names);
  EXPECT_NE(digest_of(*here.newest()), digest_of(*there.newest()));
  there.remove(*there.find("in the way"), EndReason::removed);
  ASSERT_TRUE(there.step(2, 1, {}));
  EXPECT_EQ(digest_of(*here.newest()), digest_of(*there.newest()));
}

// One unit in the last place of one coordinate of one object of 300.
TEST_F(Digests, TheLastBitOfOnePoseNamesItsObject) {
  World here{WorldOptions{}};
  fill(here, places, names_of(places));
  for (int round = 0; round < 50; ++round) {
    const std::string name = "ball_" + std::to_string(random() % places.size());
    Places others = places;
    double& x = others[name][static_cast<int>(random() % 3)];
    x = std::nextafter(x, 1e9);
    World there{WorldOptions{}};
    fill(there, others, names_of(others));
    const WorldDigest a = digest_of(*here.newest());
    const WorldDigest b = digest_of(*there.newest());
    ASSERT_NE(a, b);
    EXPECT_EQ(first_difference(*here.newest(), a, b), name);
    EXPECT_EQ(first_difference(*there.newest(), b, a), name);
  }
}

TEST_F(Digests, AnObjectThatOneWorldLacksIsNamedByTheOther) {
  World here{WorldOptions{}};
  fill(here, places, names_of(places));
  Places fewer = places;
  fewer.erase("ball_42");
  World there{WorldOptions{}};
  fill(there, fewer, names_of(fewer));
  const WorldDigest a = digest_of(*here.newest());
  const WorldDigest b = digest_of(*there.newest());
  EXPECT_EQ(first_difference(*here.newest(), a, b), "ball_42");
  EXPECT_EQ(first_difference(*there.newest(), b, a), "");
  EXPECT_EQ(first_difference(*here.newest(), a, a), "");
}

TEST_F(Digests, WhatPublishersMoveIsApartFromWhatCommandsBrought) {
  constexpr std::size_t kPublished = 2 * (WorldDigest::kGroups - WorldDigest::kUnpublishedGroups);
  const auto is_any = [](const WorldDigest& digest, std::size_t first, std::size_t last) {
    return std::any_of(digest.sums.begin() + first, digest.sums.begin() + last, [](auto sum) { return sum != 0; });
  };
  for (const std::uint64_t publisher : {0, 7}) {
    World world{WorldOptions{}};
    for (const std::string& name : names_of(places)) {
      ObjectDefinition definition;
      definition.name = name;
      definition.publisher = publisher;
      definition.moving = true;
      definition.shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = 0.5}};
      ASSERT_TRUE(std::holds_alternative<ObjectId>(world.define(definition)));
    }
    ASSERT_TRUE(world.step(1, 1, {}));
    const WorldDigest digest = digest_of(*world.newest());
    EXPECT_EQ(is_any(digest, 0, kPublished), publisher != 0);
    EXPECT_EQ(is_any(digest, kPublished, digest.sums.size()), publisher == 0);
  }
}

TEST_F(Digests, MinusZeroIsZeroAndAnotherFilterIsAnotherObject) {
  World here{WorldOptions{}};
  World there{WorldOptions{}};
  fill(here, {{"a", Vec3(0.0, 0, 0)}}, {"a"});
  fill(there, {{"a", Vec3(-0.0, 0, 0)}}, {"a"});
  EXPECT_EQ(digest_of(*here.newest()), digest_of(*there.newest()));
  World filtered{WorldOptions{}};
  ObjectDefinition definition;
  definition.name = "a";
  definition.shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = 0.5}};
  definition.filter.layers = 2;
  ASSERT_TRUE(std::holds_alternative<ObjectId>(filtered.define(definition)));
  ASSERT_TRUE(filtered.step(1, 1, {}));
  EXPECT_NE(digest_of(*here.newest()), digest_of(*filtered.newest()));
}

}  // namespace
}  // namespace collided::engine
