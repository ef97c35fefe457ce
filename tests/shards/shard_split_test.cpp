#include "idl/shards/shard_split.hpp"

#include <string>

#include <gtest/gtest.h>

namespace collided::shards {
namespace {

constexpr const char* kBefore = R"({"margin_m": 1, "shards": [
  {"name": "west", "low": [null, null, null], "high": [0, null, null]},
  {"name": "east", "low": [0, null, null], "high": [null, null, null]}]})";

std::string quarters(const std::string& north, const std::string& margin = "1", const std::string& west = "west") {
  return R"({"margin_m": )" + margin + R"(, "shards": [
  {"name": ")" +
         west + R"(", "low": [null, null, null], "high": [0, null, null]},
  {"name": "south_east", "low": [0, null, null], "high": [null, 5, null]},
  {"name": ")" +
         north + R"(", "low": [0, 5, null], "high": [null, null, null]}]})";
}

std::string split_fault_of(const std::string& next) {
  try {
    split_between(ShardMap::parse(kBefore), ShardMap::parse(next));
  } catch (const ShardMapError& wrong) { return wrong.what(); }
  return "";
}

TEST(ShardSplit, SaysWhichShardBecomesWhich) {
  const ShardSplit split = split_between(ShardMap::parse(kBefore), ShardMap::parse(quarters("north_east")));
  EXPECT_EQ(split.from, 1u);
  EXPECT_EQ(split.into, (std::vector<std::size_t>{1, 2}));
}

TEST(ShardSplit, RefusesWhateverElseIsChangedWithASentence) {
  EXPECT_EQ(split_fault_of(kBefore), "no shard is split: all of the map before are in the next one");
  EXPECT_EQ(split_fault_of(quarters("north_east", "2")), "the maps differ in their margins");
  EXPECT_EQ(split_fault_of(quarters("north_east", "1", "far_west")),
            "shards 'west' and 'east' are both gone; one is split at a time");
  EXPECT_EQ(split_fault_of(quarters("east")),
            "shard 'east' has another box; one that is split is replaced by others of new names");
  EXPECT_EQ(split_fault_of(R"({"margin_m": 1, "shards": [
    {"name": "west", "low": [null, null, null], "high": [0, null, null]},
    {"name": "orient", "low": [0, null, null], "high": [null, null, null]}]})"),
            "shard 'east' has another name; a split makes two of it or more");
}

TEST(ShardSplit, WhatIsToldOfItReadsBack) {
  const MapSuccession told{.revision = 7,
                           .phase = SuccessionPhase::in_force,
                           .from = ShardMap::parse(kBefore).fingerprint(),
                           .next = ShardMap::parse(quarters("north_east"))};
  const MapSuccession read = parse_succession(succession_text(told));
  EXPECT_EQ(read.revision, 7u);
  EXPECT_EQ(read.phase, SuccessionPhase::in_force);
  EXPECT_EQ(read.from, told.from);
  EXPECT_EQ(read.next.fingerprint(), told.next.fingerprint());
  for (const char* wrong : {"", "[]", R"({"phase": "over"})", R"({"phase": "done", "from": "12"})",
                            R"({"phase": "done", "from": "0123456789abcdef", "revision": -1})",
                            R"({"phase": "done", "from": "0123456789abcdef", "revision": 1, "map": "{}"})"}) {
    EXPECT_THROW(parse_succession(wrong), ShardMapError) << wrong;
  }
}

// While a shard is split, all of both maps are known, by places that stay; what is over is in no set.
TEST(ShardSplit, ShardsThatAreAddedOverlapAndThoseThatAreOverHoldNothing) {
  const ShardMap next = ShardMap::parse(quarters("north_east"));
  const ShardMap both = ShardMap::parse(kBefore).with({next.at(1), next.at(2)});
  const ShardBox point{.low = {3, 8, 0}, .high = {3, 8, 0}};
  EXPECT_EQ(both.all(), 0b1111u);
  EXPECT_EQ(both.holders_of(point), 0b1010u);
  EXPECT_EQ(both.owner_of({3, 8, 0}), 1u);
  const ShardMap later = both.limited_to(0b1101);
  EXPECT_EQ(later.holders_of(point), 0b1000u);
  EXPECT_EQ(later.touched_by(point), 0b1000u);
  EXPECT_EQ(later.owner_of({3, 8, 0}), 3u);
  EXPECT_EQ(later.at(1).name, "east");
}

}  // namespace
}  // namespace collided::shards
