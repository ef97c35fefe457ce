// What two servers compare: the world at whole seconds, whenever each of them steps.
#include <gtest/gtest.h>

#include "server/fleet/instant_digest.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr std::int64_t kStart = 1'000 * kSecond;
constexpr std::int64_t kBatch = kSecond / 8;

ObjectId ball(World& world, std::uint64_t publisher) {
  ObjectDefinition definition;
  definition.name = "ball";
  definition.shape.primitives = {Sphere{.center = Vec3::Zero(), .radius_m = 0.5}};
  definition.publisher = publisher;
  return std::get<ObjectId>(world.define(definition));
}

TEST(InstantDigest, AWorldThatNeverStepsHasAState) {
  const World world{WorldOptions{}};
  DigestMaker digests(world);
  ASSERT_TRUE(digests.make(kStart, kStart));
  ASSERT_NE(digests.state(), nullptr);
  ASSERT_TRUE(digests.make(kStart + kSecond, kStart + kSecond));
  EXPECT_NE(digests.state(), nullptr);
}

/// A world whose ball moves by a metre every eighth of a second, for three seconds.
class Moving {
 public:
  /// batches_a_step  so many instants are taken before each step
  void run(int batches_a_step) {
    const ObjectId id = ball(world, 7);
    for (int batch = 0; batch < 24; ++batch) {
      const std::int64_t time_ns = kStart + batch * kBatch;
      if (world.has_moved(id)) { ASSERT_TRUE(world.step(time_ns, 1, {})); }
      ASSERT_TRUE(world.move(id, {.position = {static_cast<double>(batch), 0, 0}}, time_ns, false));
      world.advance(7, time_ns);
      if (batch % batches_a_step == 0) { ASSERT_TRUE(world.step(time_ns + 1'000'000 * batches_a_step, 1, {})); }
    }
    ASSERT_TRUE(world.step(kStart + 24 * kBatch, 1, {}));
  }

  std::int64_t settled_ns() const { return world.settled_ns(kStart + 4 * kSecond); }

  World world{WorldOptions{.memory = {.reach_ns = 30 * kSecond}}};
};

TEST(InstantDigests, WhenAWorldStepsDoesNotShow) {
  Moving often, seldom;
  often.run(1);
  seldom.run(3);
  DigestMaker first(often.world);
  DigestMaker second(seldom.world);
  ASSERT_TRUE(first.make(kStart + 3 * kSecond, often.settled_ns()));
  ASSERT_TRUE(second.make(kStart + 3 * kSecond + kSecond / 2, seldom.settled_ns()));
  EXPECT_EQ(first.newest().time_ns, kStart + 2 * kSecond);
  EXPECT_EQ(second.newest().time_ns, kStart + 2 * kSecond);
  EXPECT_EQ(first.newest().digest, second.newest().digest);
  EXPECT_FALSE(first.make(kStart + 3 * kSecond + kSecond / 2, often.settled_ns())) << "there is no newer second yet";
}

TEST(InstantDigests, AWorldAtRestHasOneForEachSecondAndTheSame) {
  World world{WorldOptions{.memory = {.reach_ns = 30 * kSecond}}};
  ball(world, 0);
  ASSERT_TRUE(world.step(kStart, 1, {}));
  DigestMaker digests(world);
  ASSERT_TRUE(digests.make(kStart + 10 * kSecond, world.settled_ns(kStart + 10 * kSecond)));
  EXPECT_EQ(digests.newest().time_ns, kStart + 9 * kSecond);
  const WorldDigest before = digests.newest().digest;
  ASSERT_TRUE(digests.make(kStart + 11 * kSecond, world.settled_ns(kStart + 11 * kSecond)));
  EXPECT_EQ(digests.newest().time_ns, kStart + 10 * kSecond);
  EXPECT_EQ(digests.newest().digest, before);
}

// What a publisher has not said yet is not compared: the other server may know it already.
TEST(InstantDigests, ASecondThatAPublisherHasNotReachedWaits) {
  Moving moving;
  moving.run(1);
  World& world = moving.world;
  ASSERT_TRUE(world.move(*world.find("ball"), {.position = {99, 0, 0}}, kStart + 3 * kSecond, false));
  world.advance(7, kStart + 3 * kSecond);
  ASSERT_TRUE(world.step(kStart + 9 * kSecond, 1, {}));
  DigestMaker digests(world);
  ASSERT_TRUE(digests.make(kStart + 10 * kSecond, world.settled_ns(kStart + 10 * kSecond)));
  EXPECT_EQ(digests.newest().time_ns, kStart + 3 * kSecond);
}

/// A ball that its publisher has named, and moved at the start.
class MovedOnce {
 public:
  MovedOnce() {
    const ObjectId id = ball(world, 7);
    EXPECT_TRUE(world.move(id, {.position = {1, 0, 0}}, kStart, false));
    world.advance(7, kStart);
    EXPECT_TRUE(world.step(kStart + 1, 1, {}));
  }
  bool make(std::int64_t now_ns) { return digests.make(now_ns, world.settled_ns(now_ns)); }

  World world{WorldOptions{.memory = {.reach_ns = 30 * kSecond}}};
  DigestMaker digests{world};
};

// Where nothing steps, either: its next word may say that its objects have moved all the while.
TEST(InstantDigests, NoSecondOfALongPauseIsComparedBeforeThePublisherSpeaks) {
  MovedOnce moved;
  for (std::int64_t now_ns = kStart + kSecond; now_ns < kStart + 5 * kSecond; now_ns += kSecond / 4) {
    moved.make(now_ns);
    ASSERT_LE(moved.digests.newest().time_ns, kStart);
  }
  moved.world.advance(7, kStart + 4 * kSecond);  // it has rested; with no other publisher that is no reason to step
  ASSERT_TRUE(moved.make(kStart + 5 * kSecond + kSecond / 2));
  EXPECT_EQ(moved.digests.newest().time_ns, kStart + 4 * kSecond);
}

TEST(InstantDigests, APublisherThatIsSilentForLongHoldsNothingUp) {
  MovedOnce moved;
  ASSERT_TRUE(moved.make(kStart + 12 * kSecond));
  EXPECT_EQ(moved.digests.newest().time_ns, kStart + 11 * kSecond);
}

}  // namespace
}  // namespace collided::engine::service
