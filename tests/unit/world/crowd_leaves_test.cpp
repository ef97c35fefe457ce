// A crowd that left: its memory is given back, and nothing of it is left in answers, events or the past.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

constexpr std::int64_t kCrowdSecond = 1'000'000'000;
constexpr std::int64_t kCrowdTick = 10'000'000;

/// Bodies of one publisher in a cube, by their names.
class CrowdedWorld {
 public:
  explicit CrowdedWorld(bool remembers)
      : world({.memory = {.reach_ns = remembers ? 30 * kCrowdSecond : std::int64_t{0}}}) {}

  void come(const std::string& name, const Pose& pose) {
    ObjectDefinition definition{.name = name, .scene = "", .shape = {}, .pose = pose, .filter = {}};
    // Every second is a box, so that columns for balls have gaps.
    if (std::hash<std::string>{}(name) % 2 == 0) definition.shape.primitives = {Sphere{Vec3::Zero(), 0.5}};
    else definition.shape.primitives = {Box{.center = Vec3::Zero(), .half_m = {0.5, 0.4, 0.3}}};
    definition.publisher = 1;
    ASSERT_TRUE(std::holds_alternative<ObjectId>(world.define(definition)));
  }
  void go(const std::string& name) { ASSERT_TRUE(world.remove(*world.find(name), EndReason::removed)); }
  void move(const std::string& name, const Pose& pose) {
    ASSERT_TRUE(world.move(*world.find(name), pose, now_ns + kCrowdTick, true));
  }
  void step() {
    now_ns += kCrowdTick;
    world.advance(1, now_ns);
    ASSERT_TRUE(world.step(now_ns, 1, {}));
  }
  std::set<std::pair<std::string, std::string>> contacts() const {
    std::set<std::pair<std::string, std::string>> names;
    for (const OpenContact& open : world.contacts()) {
      std::string a = world.info(open.a)->name, b = world.info(open.b)->name;
      if (b < a) std::swap(a, b);
      names.emplace(a, b);
    }
    return names;
  }

  World world;
  std::int64_t now_ns = 1'000 * kCrowdSecond;
};

class CrowdLeaves : public testing::TestWithParam<bool> {
 protected:
  Pose place(double side_m) {
    std::uniform_real_distribution<double> along(0, side_m), turn(-1, 1);
    const double x = along(random), y = along(random), z = along(random);
    const double a = turn(random), b = turn(random), c = turn(random);
    return {.position = {x, y, z}, .rotation = Quat(1.5, a, b, c).normalized()};
  }
  std::mt19937_64 random = oracle::seeded(20261130);
};

TEST_P(CrowdLeaves, TheRowsAfterTheLastObjectAreGivenBack) {
  constexpr int kCount = 6'000;
  CrowdedWorld crowded(GetParam());
  for (int i = 0; i < kCount; ++i) crowded.come("one " + std::to_string(i), place(20));
  crowded.step();
  EXPECT_EQ(crowded.world.newest()->poses.size(), kCount);
  const std::int64_t full_ns = crowded.now_ns;
  for (int i = 4; i < kCount; ++i) crowded.go("one " + std::to_string(i));
  for (int i = 0; i < 3; ++i) crowded.step();
  EXPECT_EQ(crowded.world.newest()->poses.size(), 4u);
  EXPECT_LE(crowded.world.newest()->poses.capacity(), 4'096u);
  EXPECT_FALSE(crowded.world.find("one 4"));
  // A newcomer takes a low slot, under a new id.
  crowded.come("newcomer", place(20));
  const ObjectId id = *crowded.world.find("newcomer");
  EXPECT_EQ(slot_of(id), 4u);
  EXPECT_GT(id >> 32, 1u);
  crowded.step();
  EXPECT_EQ(crowded.world.newest()->poses.size(), 5u);
  if (!GetParam()) return;
  const auto then = crowded.world.memory().at(full_ns);
  ASSERT_TRUE(then);
  std::set<std::string> names;
  for (const auto& info : then->objects) {
    if (info) names.insert(info->name);
  }
  EXPECT_EQ(names.size(), kCount) << "all of them were there";
}

// Crowds come, move, and go in a world that so grows and shrinks: always the contacts of a world that only ever had those
// who are there.
TEST_P(CrowdLeaves, ContactsAreThoseOfAWorldWithoutAPast) {
  constexpr double kSide_m = 9;
  CrowdedWorld crowded(GetParam());
  std::map<std::string, Pose> there;
  int next = 0;
  for (const int most : {1'500, 20, 700, 0, 1'200, 3, 300}) {
    while (static_cast<int>(there.size()) < most) {
      const std::string name = "body " + std::to_string(next++);
      crowded.come(name, there[name] = place(kSide_m));
    }
    while (static_cast<int>(there.size()) > most) {
      const auto gone = std::next(there.begin(), static_cast<std::ptrdiff_t>(random() % there.size()));
      crowded.go(gone->first);
      there.erase(gone);
    }
    crowded.step();
    for (int i = 0; i < 6; ++i) {
      for (auto& [name, pose] : there) {
        if (random() % 3 == 0) continue;
        pose = place(kSide_m);
        crowded.move(name, pose);
      }
      crowded.step();
    }
    CrowdedWorld anew(false);
    for (const auto& [name, pose] : there) anew.come(name, pose);
    anew.step();
    EXPECT_EQ(crowded.contacts(), anew.contacts()) << most;
    const auto state = crowded.world.newest();
    for (const auto& [name, pose] : there) {
      const std::uint32_t slot = slot_of(*crowded.world.find(name));
      ASSERT_LT(slot, state->poses.size());
      EXPECT_EQ(state->poses[slot].position, pose.position);
      EXPECT_EQ(state->objects[slot]->name, name);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutAPast, CrowdLeaves, testing::Bool());

}  // namespace
}  // namespace collided::engine
