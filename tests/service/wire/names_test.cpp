// Which names ids have, as messages tell them.
#include "client/library/connection/names.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <vector>

#include "idl/standing_ids.hpp"
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

TEST(Names, AStandingQuestionInASlotOfTheSameNumberDisplacesNoObject) {
  constexpr std::uint64_t kObject = 5, kStanding = codes::kStandingBit | kObject;
  EXPECT_TRUE(wire_contract::is_standing_id(kStanding));
  EXPECT_FALSE(wire_contract::is_standing_id(kObject));
  client::Names names;
  learn(names, {kObject, kStanding}, {"ball", "dock"});
  EXPECT_EQ(names.name(kObject), "ball");
  EXPECT_EQ(names.name(kStanding), "dock");
}

// The server's own bits above a slot belong to its generation, whatever they mean to it.
TEST(Names, ASlotHasOneStandingQuestionAtATime) {
  constexpr std::uint64_t kFirst = codes::kStandingBit | 6, kNext = kFirst | (std::uint64_t{1} << 62);
  client::Names names;
  learn(names, {kFirst}, {"dock"});
  learn(names, {kNext}, {"escape"});
  EXPECT_EQ(names.name(kNext), "escape");
  EXPECT_EQ(names.name(kFirst), "#9223372036854775814");
}

}  // namespace
}  // namespace collided
