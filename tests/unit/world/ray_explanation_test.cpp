// Why a ray meets what it meets: against rationals, and by hand.
#include "server/world/explain/ray_explanation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>

#include "server/world/world.hpp"
#include "tests/oracle/exact_oracle.hpp"
#include "tests/oracle/seed.hpp"

// Behind the oracle, which has the names of engine where these are.
#include <collided/explanations.hpp>

namespace collided::engine::ray_explanation_test {
namespace {

using oracle::Rational;

constexpr double kEndless = std::numeric_limits<double>::infinity();

class RayExplanationTest : public testing::Test {
 protected:
  ObjectId add(const std::string& name, const std::vector<Primitive>& shape, const Vec3& at,
               const Filter& filter = {}) {
    ObjectDefinition definition;
    definition.name = name;
    definition.shape.primitives = shape;
    definition.pose.position = at;
    definition.filter = filter;
    definition.moving = !std::holds_alternative<HalfSpace>(shape.front());
    return std::get<ObjectId>(world_.define(definition));
  }
  ExplainedRay explained(const RayExplanationAsk& ask) {
    EXPECT_TRUE(world_.step(now_ns_ += 1'000, 1, {}));
    const SnapshotRing::Lease state = world_.newest();
    Deadline never;
    return explain_ray(*state, ask, part_meshes_, never);
  }
  static RayExplanationAsk ray(const Vec3& from, const Vec3& direction, double length_m = kEndless) {
    return {.numbers = {from.x(), from.y(), from.z(), direction.x(), direction.y(), direction.z(), length_m},
            .only = {},
            .skip = {}};
  }

  World world_{WorldOptions{}};
  PartMeshes part_meshes_;
  std::int64_t now_ns_ = 1'000'000'000'000;
};

Rational dot(const oracle::Point& a, const oracle::Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// The square of the distance of a point from an endless ray.
Rational squared_distance(const Vec3& from, const Vec3& direction, const Vec3& point) {
  const oracle::Point o = oracle::exact(from);
  const oracle::Point d = oracle::exact(direction);
  oracle::Point away = oracle::exact(point);
  for (std::size_t i = 0; i < 3; ++i) away[i] -= o[i];
  Rational t = dot(away, d) / dot(d, d);
  if (t < 0) t = 0;
  for (std::size_t i = 0; i < 3; ++i) away[i] -= t * d[i];
  return dot(away, away);
}

// Every distance holds the rational truth, what is met is what rationals say is met, and nothing nearer is left out.
TEST_F(RayExplanationTest, MissesHoldTheirRationalDistances) {
  std::mt19937_64 random = oracle::seeded(2'731);
  std::uniform_real_distribution<double> place(-5, 5);
  std::uniform_real_distribution<double> size(0, 0.8);
  std::map<std::string, std::pair<Vec3, double>> balls;
  for (int i = 0; i < 60; ++i) {
    const Vec3 at(place(random), place(random), place(random));
    const double radius_m = size(random);
    const std::string name = "ball" + std::to_string(i);
    add(name, {Sphere{Vec3::Zero(), radius_m}}, at);
    balls[name] = {at, radius_m};
  }
  std::size_t met = 0;
  for (int round = 0; round < 100; ++round) {
    const Vec3 from(place(random), place(random), place(random));
    const Vec3 direction(place(random), place(random), place(random));
    RayExplanationAsk ask = ray(from, direction);
    ask.most_misses = 5;
    const ExplainedRay told = explained(ask);
    std::vector<Rational> all;
    for (const auto& [name, ball] : balls) {
      const Rational square = squared_distance(from, direction, ball.first);
      const Rational radius(ball.second);
      const bool is_met = square <= radius * radius;
      const bool is_told = std::any_of(told.met.begin(), told.met.end(),
                                       [&](const ExplainedMeeting& meeting) { return meeting.object == name; });
      EXPECT_EQ(is_met, is_told) << name;
      met += is_met ? 1 : 0;
    }
    ASSERT_EQ(told.misses.size(), 5u);
    std::map<std::string, double> upper;
    for (const ExplainedMiss& miss : told.misses) {
      const auto& [center, radius_m] = balls.at(miss.object);
      const Rational square = squared_distance(from, direction, center);
      const Rational low = Rational(radius_m) + Rational(miss.distance_m) - Rational(miss.error_m);
      const Rational high = Rational(radius_m) + Rational(miss.distance_m) + Rational(miss.error_m);
      EXPECT_TRUE(low < 0 || low * low <= square) << miss.object;
      EXPECT_LE(square, high * high) << miss.object;
      EXPECT_LT(miss.error_m, 1e-12);
      upper[miss.object] = miss.distance_m + miss.error_m;
    }
    const ExplainedMiss& last = told.misses.back();
    for (const auto& [name, ball] : balls) {
      if (upper.contains(name)) continue;
      const Rational square = squared_distance(from, direction, ball.first);
      if (square <= Rational(ball.second) * Rational(ball.second)) continue;
      const Rational nearest = Rational(ball.second) + Rational(last.distance_m) - Rational(last.error_m);
      EXPECT_GE(square, nearest * nearest) << name << " is nearer than " << last.object;
    }
  }
  EXPECT_GT(met, 20u);
}

// A 3-4-5 triangle: the ray from (0 0 0) along (4 3 0) passes (4 -3 0) at 24 / 5, at 7 / 5 along.
TEST_F(RayExplanationTest, ByHandItPassesAtThreeCentimetresWhereItSays) {
  add("tower", {Sphere{Vec3::Zero(), 1.032}}, {5, 0, -6});
  add("ball", {Sphere{Vec3::Zero(), 1}}, {4, -3, 0});
  const ExplainedRay told = explained(ray({0, 0, 0}, {4, 3, 0}));
  EXPECT_EQ(told.verdict, collided::Verdict::miss);
  ASSERT_EQ(told.misses.size(), 2u);
  EXPECT_EQ(told.misses[0].object, "ball");
  EXPECT_NEAR(told.misses[0].distance_m, 3.8, told.misses[0].error_m + 1e-15);
  EXPECT_NEAR(told.misses[0].along_m, 1.4, 1e-12);
  EXPECT_FALSE(told.misses[0].box_met);
  // Straight down past (1.032 0 -6): 3.2 cm beside a ball of 1 m.
  add("column", {Sphere{Vec3::Zero(), 1}}, {101.032, 0, -6});
  const ExplainedRay past = explained(ray({100, 0, 0}, {0, 0, -1}));
  EXPECT_EQ(past.misses[0].object, "column");
  EXPECT_NEAR(past.misses[0].distance_m, 0.032, past.misses[0].error_m + 1e-14);
  EXPECT_NEAR(past.misses[0].along_m, 6, 1e-9);
}

TEST_F(RayExplanationTest, WhereTheRayEndsOrBeginsIsSaid) {
  add("beyond", {Sphere{Vec3::Zero(), 1}}, {10, 0, 0});
  add("behind", {Sphere{Vec3::Zero(), 1}}, {-4, 0, 0});
  const ExplainedRay told = explained(ray({0, 0, 0}, {2, 0, 0}, 7));
  ASSERT_EQ(told.misses.size(), 2u);
  EXPECT_EQ(told.misses[0].object, "beyond");
  EXPECT_NEAR(told.misses[0].distance_m, 2, 1e-12);
  EXPECT_EQ(told.misses[0].where, WhereMissed::end);
  EXPECT_EQ(told.misses[1].object, "behind");
  EXPECT_NEAR(told.misses[1].distance_m, 3, 1e-12);
  EXPECT_EQ(told.misses[1].where, WhereMissed::start);
}

// Its numbers are endless, but the ray leaves it at once and comes no nearer.
TEST_F(RayExplanationTest, AGroundIsNearestWhereTheRayBegins) {
  add("ground", {HalfSpace{.point = {0, 0, 0}, .normal = {0, 0, 1}}}, {0, 0, 0});
  const ExplainedRay told = explained(ray({3, 0, 2.5}, {1, 0, 1}));
  ASSERT_EQ(told.misses.size(), 1u);
  EXPECT_NEAR(told.misses[0].distance_m, 2.5, told.misses[0].error_m + 1e-15);
  EXPECT_EQ(told.misses[0].where, WhereMissed::start);
}

TEST_F(RayExplanationTest, WhatTheFilterLeavesOutComesWithItsReason) {
  add("glass", {Sphere{Vec3::Zero(), 1}}, {3, 0, 0}, {.layers = 2});
  add("dust_1", {Sphere{Vec3::Zero(), 1}}, {6, 0, 0}, {.layers = 4});
  add("wall", {Sphere{Vec3::Zero(), 1}}, {9, 0, 0}, {.layers = 4});
  add("far", {Sphere{Vec3::Zero(), 1}}, {12, 0, 0}, {.layers = 2});
  RayExplanationAsk ask = ray({0, 0, 0}, {1, 0, 0});
  ask.mask = 4;
  ask.skip = "dust*";
  const ExplainedRay told = explained(ask);
  EXPECT_EQ(told.verdict, collided::Verdict::hit);
  ASSERT_EQ(told.met.size(), 1u);
  EXPECT_EQ(told.met[0].object, "wall");
  EXPECT_EQ(told.left_out_count, 3u);
  ASSERT_EQ(told.left_out.size(), 2u);
  EXPECT_EQ(told.left_out[0].object, "glass");
  EXPECT_EQ(told.left_out[0].why_left_out, "its layers 0x2 are not in the mask 0x4");
  EXPECT_EQ(told.left_out[1].why_left_out, "'dust*' was to be skipped");
  // One that lies behind the answer is told of when it is asked for.
  ask.why_not = world_.find("far");
  EXPECT_EQ(explained(ask).left_out.size(), 3u);
}

TEST_F(RayExplanationTest, ThePartAndTheRungThatDecidedAreTold) {
  add("robot", {Sphere{Vec3::Zero(), 0.5}, Box{.center = {-2, 0, 0}, .half_m = {0.5, 0.5, 0.5}}}, {5, 0, 0});
  const ExplainedRay plain = explained(ray({0, 0, 0}, {1, 0, 0}));
  ASSERT_EQ(plain.met.size(), 1u);
  EXPECT_EQ(plain.met[0].part, 1u);
  EXPECT_EQ(plain.met[0].rung, Rung::filter);
  EXPECT_DOUBLE_EQ(plain.met[0].distance_m, 2.5);
  const ExplainedRay down = explained(ray({5, 0.25, 3}, {0, 0, -1}));
  ASSERT_EQ(down.met.size(), 1u);
  EXPECT_EQ(down.met[0].part, 0u);
}

}  // namespace
}  // namespace collided::engine::ray_explanation_test
