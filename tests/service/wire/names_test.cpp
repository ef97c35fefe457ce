// Which names ids have, as messages tell them.
#include "client/library/connection/names.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "idl/fence_ids.hpp"
#include "idl/topics.hpp"

namespace collided {
namespace {

void learn(client::Names& names, const std::vector<std::uint64_t>& ids, const std::vector<std::string>& texts) {
  names.learn(ids, wire_contract::pack_names(texts));
}

TEST(Names, ASlotHasOneObjectAtATime) {
  constexpr std::uint64_t kFirst = 5, kNext = kFirst + (std::uint64_t{1} << 32);
  client::Names names;
  EXPECT_EQ(names.name(kFirst), "#5");
  learn(names, {kFirst}, {"crate"});
  learn(names, {kNext}, {"cart"});
  EXPECT_EQ(names.name(kNext), "cart");
  EXPECT_EQ(names.name(kFirst), "#5");
}

TEST(Names, AFenceInASlotOfTheSameNumberDisplacesNoObject) {
  constexpr std::uint64_t kObject = 5, kFence = (std::uint64_t{1} << 63) | 5,
                          kNearest = wire_contract::kNearestBits | 6;
  client::Names names;
  learn(names, {kObject, kFence, kObject + 1, kNearest}, {"ball", "dock", "cube", "escape"});
  EXPECT_EQ(names.name(kObject), "ball");
  EXPECT_EQ(names.name(kFence), "dock");
  EXPECT_EQ(names.name(kObject + 1), "cube");
  EXPECT_EQ(names.name(kNearest), "escape");
}

}  // namespace
}  // namespace collided
