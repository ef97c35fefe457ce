#include <gtest/gtest.h>

#include <limits>

#include "server/world/step/separation_cache.hpp"

namespace collided::engine {
namespace {

TEST(SeparationCache, HoldsUntilTheGapIsUsedUpByEither) {
  SeparationCache memory;
  memory.remember(3, 7, 1.0);
  EXPECT_TRUE(memory.holds(3, 7));
  EXPECT_TRUE(memory.holds(7, 3));
  EXPECT_FALSE(memory.holds(3, 8));
  memory.moved(3, 0.4);
  memory.moved(7, 0.5);
  EXPECT_TRUE(memory.holds(7, 3));
  memory.moved(7, 0.1);
  EXPECT_FALSE(memory.holds(7, 3)) << "1.0 of 1.0 gone: they may touch";
}

TEST(SeparationCache, NothingHoldsOfAnObjectThatWasPlaced) {
  SeparationCache memory;
  memory.moved(3, 5);
  memory.remember(3, 7, 1.0);
  memory.placed(3);
  EXPECT_FALSE(memory.holds(3, 7));
  memory.remember(7, 3, 1.0);
  EXPECT_TRUE(memory.holds(3, 7));
  memory.moved(7, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(memory.holds(3, 7));
  memory.clear();
  EXPECT_EQ(memory.size(), 0U);
}

// A long way is summed in steps that each vanish in it; none of them may be lost.
TEST(SeparationCache, ManySmallStepsAreNotRoundedAway) {
  SeparationCache memory;
  memory.moved(1, 0x1p60);
  memory.remember(1, 2, 100.0);
  for (int i = 0; i < 100; ++i) memory.moved(1, 1.0);
  EXPECT_FALSE(memory.holds(1, 2));
}

TEST(SeparationCache, WhatWasLookedForInVainIsLookedForAgainLater) {
  SeparationCache memory;
  EXPECT_TRUE(memory.is_worth_looking(1, 2));
  memory.looked_in_vain(1, 2);
  EXPECT_FALSE(memory.is_worth_looking(2, 1));
  EXPECT_FALSE(memory.holds(1, 2));
  for (int step = 0; step < 8; ++step) memory.end_step();
  EXPECT_TRUE(memory.is_worth_looking(2, 1));
}

TEST(SeparationCache, ForgetsWhatNobodyAsksFor) {
  SeparationCache memory;
  memory.remember(1, 2, 1e9);
  memory.remember(3, 4, 1e9);
  for (int step = 0; step < 1'000; ++step) {
    EXPECT_TRUE(memory.holds(1, 2));
    memory.end_step();
  }
  EXPECT_EQ(memory.size(), 1U);
}

TEST(SeparationCache, KeepsABoundedNumberOfPairs) {
  SeparationCache memory;
  for (std::uint32_t i = 0; i < SeparationCache::kMost + 1'000; ++i) memory.remember(i, i + 1, 1.0);
  EXPECT_EQ(memory.size(), SeparationCache::kMost);
  EXPECT_FALSE(memory.is_worth_looking(SeparationCache::kMost + 10, 5));
}

}  // namespace
}  // namespace collided::engine
