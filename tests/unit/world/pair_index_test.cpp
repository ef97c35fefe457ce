#include "server/world/events/pair_index.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

// What is prefetched is what is read, but for pairs that share 32 bits of their hash.
TEST(PairIndex, AGuessIsTheNumberOfAPairThatIsThere) {
  std::mt19937_64 random = oracle::seeded(20261128);
  PairIndex index;
  EXPECT_EQ(index.guess(1, 2), PairIndex::kNone);
  index.prefetch(1, 2);
  constexpr std::uint32_t kPairs = 20'000;
  std::vector<std::pair<ObjectId, ObjectId>> pairs;
  for (std::uint32_t number = 0; number < kPairs; ++number) {
    pairs.emplace_back(random(), random());
    index.add(pairs.back().first, pairs.back().second, number);
  }
  std::uint32_t right = 0;
  std::uint32_t invented = 0;
  for (std::uint32_t number = 0; number < kPairs; ++number) {
    index.prefetch(pairs[number].first, pairs[number].second);
    right += index.guess(pairs[number].first, pairs[number].second) == number ? 1 : 0;
    invented += index.guess(random(), random()) != PairIndex::kNone ? 1 : 0;
  }
  EXPECT_GE(right, kPairs - 10);
  EXPECT_LE(invented, 10u);
}

}  // namespace
}  // namespace collided::engine
