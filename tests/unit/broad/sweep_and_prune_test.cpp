// A52, A39, A51: sweep-and-prune against all pairs, in every frame.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "server/broad_phase/sweep_and_prune/sweep_and_prune.hpp"
#include "tests/oracle/box_pairs.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/broad/bvh_walks.hpp"

namespace collided::engine {
namespace {

constexpr double kEndlessSweep = std::numeric_limits<double>::infinity();
using oracle::pairs_by_force;
using oracle::pairs_of;
using Pairs = oracle::BoxPairs;

/// Half of them the bounds of spheres, some empty, one without end, many that only touch.
std::vector<Aabb> mixed_boxes(std::size_t count, std::mt19937_64& random) {
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 place = 10 * in_cube(random);
    switch (random() % 8) {
      case 0: boxes.push_back({}); break;
      case 1: boxes.push_back({place.array().floor(), place.array().floor() + 1}); break;
      case 2: boxes.push_back({place, place}); break;
      case 3: boxes.push_back({place, place + in_cube(random).cwiseAbs()}); break;
      default: boxes.push_back(bounds(Sphere{.center = place, .radius_m = 0.5}));
    }
  }
  boxes.front() = {Vec3(-kEndlessSweep, 0, 0), Vec3(kEndlessSweep, 1, 1)};
  return boxes;
}

TEST(SweepAndPrune, EqualsAllPairsInEveryFrameOfCoherentMotion) {
  std::mt19937_64 random = oracle::seeded(20261122);
  for (const std::size_t count : {1, 7, 8, 9, 200, 1000}) {
    std::vector<Aabb> boxes = mixed_boxes(count, random);
    SweepAndPrune sweep;
    for (int frame = 0; frame < 20; ++frame) {
      for (Aabb& box : boxes) {
        const Vec3 motion = 0.05 * in_cube(random);
        box.low += motion;
        box.high += motion;
      }
      sweep.update(boxes);
      ASSERT_EQ(pairs_of(sweep), pairs_by_force(boxes)) << count << " boxes, frame " << frame;
      EXPECT_EQ(sweep.report().is_sorted_anew, frame == 0);
    }
  }
}

TEST(SweepAndPrune, EqualsAllPairsWhereBoxesComeGoTeleportAndChangeTheAxis) {
  std::mt19937_64 random = oracle::seeded(20261123);
  SweepAndPrune sweep;
  for (int frame = 0; frame < 60; ++frame) {
    std::vector<Aabb> boxes = mixed_boxes(1 + random() % 300, random);
    // A street along one axis, another one in every few frames.
    const int along = frame / 5 % 3;
    for (Aabb& box : boxes) {
      box.low[along] *= 100;
      box.high[along] *= 100;
    }
    sweep.update(boxes);
    ASSERT_EQ(pairs_of(sweep), pairs_by_force(boxes)) << "frame " << frame;
  }
  sweep.update({});
  EXPECT_EQ(sweep.size(), 0u);
  EXPECT_TRUE(pairs_of(sweep).empty());
}

TEST(SweepAndPrune, ABoxThatEmptiesOrFillsIsNotTakenForTheLastOneInItsPlace) {
  std::vector<Aabb> boxes(3, Aabb{Vec3::Zero(), Vec3::Ones()});
  boxes[2] = {};
  SweepAndPrune sweep;
  sweep.update(boxes);
  EXPECT_EQ(pairs_of(sweep), (Pairs{{0, 1}}));
  std::swap(boxes[1], boxes[2]);
  sweep.update(boxes);
  EXPECT_EQ(pairs_of(sweep), (Pairs{{0, 2}}));
}

TEST(SweepAndPrune, EndsWhereToldTo) {
  const std::vector<Aabb> boxes(100, Aabb{Vec3::Zero(), Vec3::Ones()});
  SweepAndPrune sweep;
  sweep.update(boxes);
  WalkCost cost;
  int told = 0;
  sweep.pairs([&](std::uint32_t, std::uint32_t) { return ++told < 10; }, cost);
  EXPECT_EQ(told, 10);
}

/// Few swaps for the objects where they hardly move; a sort from nothing, not a quadratic one, where all are elsewhere.
TEST(SweepAndPrune, SwapsLittleWhereLittleMovesAndSortsAnewAfterATeleport) {
  std::mt19937_64 random = oracle::seeded(20261124);
  constexpr std::size_t kCount = 20'000;
  std::vector<Aabb> boxes;
  for (std::size_t i = 0; i < kCount; ++i) {
    const Vec3 low = (1e4 * in_cube(random)).eval();
    boxes.push_back({low, low + Vec3::Ones()});
  }
  SweepAndPrune sweep;
  sweep.update(boxes);
  EXPECT_TRUE(sweep.report().is_sorted_anew);
  for (Aabb& box : boxes) {
    const Vec3 motion = in_cube(random);
    box.low += motion;
    box.high += motion;
  }
  sweep.update(boxes);
  EXPECT_FALSE(sweep.report().is_sorted_anew);
  EXPECT_LT(sweep.report().swaps, kCount);
  EXPECT_GT(sweep.report().swaps, 0u);
  for (Aabb& box : boxes) {
    const Vec3 low = (1e4 * in_cube(random)).eval();
    box = {low, low + Vec3::Ones()};
  }
  sweep.update(boxes);
  EXPECT_TRUE(sweep.report().is_sorted_anew);
}

// A52: in coherent motion along a street the swaps of a frame grow as the objects, not as a sort; after a teleport as many
// are sorted anew. Counts, so that no clock decides; the boxes are those of spheres.
TEST(SweepAndPrune, SwapsGrowLinearlyWithTheObjects) {
  std::mt19937_64 random = oracle::seeded(20261125);
  std::vector<double> swaps_each;
  for (const std::size_t count : {1'000, 4'000, 16'000, 64'000}) {
    std::vector<Sphere> spheres;
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3 place = in_cube(random);
      spheres.push_back({{0.5 * static_cast<double>(count) * place[0], place[1], place[2]}, 0.2});
    }
    SweepAndPrune sweep;
    const auto update = [&](double motion_m) {
      std::vector<Aabb> boxes;
      for (Sphere& sphere : spheres) {
        sphere.center += motion_m * in_cube(random);
        boxes.push_back(bounds(sphere));
      }
      sweep.update(boxes);
    };
    update(0);
    std::uint64_t swaps = 0;
    for (int frame = 0; frame < 10; ++frame) {
      update(0.2);
      EXPECT_FALSE(sweep.report().is_sorted_anew);
      swaps += sweep.report().swaps;
    }
    swaps_each.push_back(static_cast<double>(swaps) / 10 / static_cast<double>(count));
    update(static_cast<double>(count));
    std::printf("%zu objects: %.3f swaps each a frame, beside %.1f comparisons of a whole sort; teleported: %s\n",
                count, swaps_each.back(), std::log2(static_cast<double>(count)),
                sweep.report().is_sorted_anew ? "sorted anew" : "by swaps");
    EXPECT_TRUE(sweep.report().is_sorted_anew);
  }
  for (const double each : swaps_each) {
    EXPECT_GT(each, 0.7 * swaps_each.front());
    EXPECT_LT(each, 1.4 * swaps_each.front());
  }
}

}  // namespace
}  // namespace collided::engine
