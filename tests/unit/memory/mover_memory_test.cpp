// What a mover takes, two published states and the index over them included, and that it is given back.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "server/world/world.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/memory/counting.hpp"

namespace collided::engine {
namespace {

constexpr std::size_t kMovers = 20'000;
constexpr double kRoomOfEach_m3 = 10;  // one in eight touches another
constexpr std::int64_t kPeriod_ns = 10'000'000;

struct Crowd {
  explicit Crowd(const Primitive& shape) : random(oracle::seeded(20261201)) {
    const double side_m = std::cbrt(kRoomOfEach_m3 * static_cast<double>(kMovers));
    std::uniform_real_distribution<double> along(0, side_m);
    ids.reserve(kMovers);
    poses.reserve(kMovers);
    other_bytes = test::held_bytes();
    for (std::size_t i = 0; i < kMovers; ++i) {
      ObjectDefinition definition{.name = std::to_string(i), .scene = "", .shape = {}, .pose = {}, .filter = {}};
      definition.shape.primitives = {shape};
      definition.pose.position = {along(random), along(random), along(random)};
      definition.publisher = 1;
      ids.push_back(std::get<ObjectId>(world.define(definition)));
      poses.push_back(definition.pose);
    }
    step();
  }
  void step() {
    now_ns += kPeriod_ns;
    world.advance(1, now_ns);
    ASSERT_TRUE(world.step(now_ns, 1, {}));
  }
  void move() {
    std::uniform_real_distribution<double> shift(-0.02, 0.02);
    for (Pose& pose : poses) pose.position += Vec3(shift(random), shift(random), shift(random));
    const auto moved = std::make_unique<bool[]>(kMovers);
    world.move(ids, poses, now_ns + kPeriod_ns, false, std::span(moved.get(), kMovers));
    step();
  }
  double bytes_a_mover() const {
    return (static_cast<double>(test::held_bytes()) - static_cast<double>(other_bytes)) / kMovers;
  }

  std::mt19937_64 random;
  World world{{.max_objects = kMovers}};
  std::vector<ObjectId> ids;
  std::vector<Pose> poses;
  std::size_t other_bytes = 0;
  std::int64_t now_ns = 1'000'000'000'000;
};

class MoverMemory : public testing::TestWithParam<Primitive> {};

TEST_P(MoverMemory, IsBoundedAndGivenBack) {
  constexpr double kMost_bytes =
      900;  // with its contacts and its part of two states' indexes, 70 bytes of a tree in each
  Crowd crowd(GetParam());
  for (int i = 0; i < 3; ++i) crowd.move();
  const double at_work = crowd.bytes_a_mover();
  std::printf("%.0f bytes a mover, %zu contacts\n", at_work, crowd.world.contacts().size());
  EXPECT_LT(at_work, kMost_bytes);

  for (const ObjectId id : crowd.ids) ASSERT_TRUE(crowd.world.remove(id, EndReason::removed));
  for (int i = 0; i < 4; ++i) crowd.step();
  const double left = crowd.bytes_a_mover();
  std::printf("%.0f bytes after they left\n", left);
  // What is left are narrow columns of all slots, and 1.2 MB of placed boxes, whatever their number.
  EXPECT_LT(left, 200);
}

TEST_P(MoverMemory, IsGivenBackAsMoversLeave) {
  Crowd crowd(GetParam());
  crowd.move();
  const double before = crowd.bytes_a_mover();
  // Slots are given in order, so that rows are free at the end.
  for (std::size_t i = kMovers; i > kMovers / 2; --i) {
    ASSERT_TRUE(crowd.world.remove(crowd.ids[i - 1], EndReason::removed));
    if (i % 1'000 == 1) crowd.step();
  }
  for (int i = 0; i < 2; ++i) crowd.step();
  const double left = crowd.bytes_a_mover();
  std::printf("%.0f bytes a mover, and when half of them had left %.0f\n", before, left);
  EXPECT_LT(left, 0.75 * before);
}

TEST_P(MoverMemory, IsGivenBackWhateverTheOrderInWhichMoversLeave) {
  Crowd crowd(GetParam());
  crowd.move();
  std::shuffle(crowd.ids.begin(), crowd.ids.end(), crowd.random);
  for (std::size_t i = 0; i < kMovers; ++i) {
    ASSERT_TRUE(crowd.world.remove(crowd.ids[i], EndReason::removed));
    if ((i + 1) % (kMovers / 10) == 0) crowd.step();
  }
  for (int i = 0; i < 3; ++i) crowd.step();
  EXPECT_LT(crowd.bytes_a_mover(), 200);
}

INSTANTIATE_TEST_SUITE_P(, MoverMemory,
                         testing::Values(Primitive(Sphere{Vec3::Zero(), 0.5}),
                                         Primitive(Box{.center = Vec3::Zero(), .half_m = {0.5, 0.4, 0.3}})));

}  // namespace
}  // namespace collided::engine
