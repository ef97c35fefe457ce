#include "idl/shards/shard_map.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace collided::shards {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

constexpr const char* kHalves = R"({"margin_m": 2, "shards": [
  {"name": "west", "low": [null, null, null], "high": [0, null, null]},
  {"name": "east", "low": [0, null, null], "high": [null, null, null]}]})";

std::string fault_of(const std::string& text) {
  try {
    ShardMap::parse(text);
  } catch (const ShardMapError& wrong) { return wrong.what(); }
  return "";
}

TEST(ShardMap, SaysWhoHoldsWhatAndToWhomAPointBelongs) {
  const ShardMap map = ShardMap::parse(kHalves);
  ASSERT_EQ(map.size(), 2u);
  EXPECT_EQ(map.find("east"), 1u);
  EXPECT_FALSE(map.find("north"));
  EXPECT_EQ(map.holders_of({{3, 0, 0}, {4, 1, 1}}), 0b10u);
  EXPECT_EQ(map.holders_of({{2, 0, 0}, {4, 1, 1}}), 0b11u) << "the margin belongs to both, and so does its border";
  EXPECT_EQ(map.touched_by({{-2, 0, 0}, {-1, 0, 0}}), 0b01u);
  EXPECT_EQ(map.touched_by({{-2, 0, 0}, {0, 0, 0}}), 0b11u);
  EXPECT_EQ(map.owner_of({0, 5, 5}), 0u) << "what is on a border belongs to the first";
  EXPECT_EQ(map.owner_of({1e-300, 5, 5}), 1u);
  EXPECT_EQ(map.at(0).box.low[0], -kFar);
  EXPECT_EQ(map.all(), 0b11u);
}

TEST(ShardMap, RefusesWhatDoesNotFillSpaceOnce) {
  EXPECT_EQ(fault_of(R"({"shards": [{"name": "a", "low": [null, null, null], "high": [1, null, null]},
                                    {"name": "b", "low": [0, null, null], "high": [null, null, null]}]})"),
            "shards 'a' and 'b' overlap from (0.0, -endless, -endless) to (1.0, endless, endless)");
  EXPECT_EQ(
      fault_of(R"({"shards": [{"name": "a", "low": [null, null, null], "high": [0, null, null]},
                                    {"name": "b", "low": [1, null, null], "high": [null, null, null]}]})"),
      "no shard holds what is at (0.5, 0.0, 0.0); the boxes must fill space, with null for a side that has no end");
  EXPECT_EQ(fault_of(R"({"shards": [{"name": "a", "low": [0, 0, 0], "high": [1, 1, 1]}]})"),
            "no shard holds what is at (-1.0, -1.0, -1.0); the boxes must fill space, with null for a side that has no "
            "end");
  EXPECT_EQ(fault_of(R"({"shards": [{"name": "a", "low": [null, null, null], "high": [0, null, null]},
                                    {"name": "a", "low": [0, null, null], "high": [null, null, null]}]})"),
            "two shards are called 'a'");
}

TEST(ShardMap, SaysWhatIsWrongWithItsText) {
  EXPECT_EQ(fault_of("[]"), "the shard map is no JSON object");
  EXPECT_EQ(fault_of(R"({"shards": []})"), "'shards' must be a list of 1 to 64 shards");
  EXPECT_EQ(fault_of(R"({"margin": 1, "shards": []})"), "the shard map: unknown key 'margin'");
  EXPECT_EQ(fault_of(R"({"margin_m": 0, "shards": []})"), "'margin_m' is 0; allowed are numbers from 0.001");
  EXPECT_EQ(fault_of(R"({"shards": [{"name": "a b", "low": [null,null,null], "high": [null,null,null]}]})"),
            "shard 0: its name must be 1 to 63 letters, digits or '_'");
  EXPECT_EQ(fault_of(R"({"shards": [{"name": "a", "low": [null,"0",null], "high": [null,null,null]}]})"),
            "shard 'a': 'low' has \"0\"; allowed are numbers, and null for endless");
  EXPECT_EQ(
      fault_of(R"({"shards": [{"name": "a", "low": [1,null,null], "high": [1,null,null]}]})"),
      "shard 'a': 'low' must be below 'high'; it reaches from (1.0, -endless, -endless) to (1.0, endless, endless)");
  EXPECT_NE(fault_of(std::string(ShardMap::kMostBytes + 1, ' ')), "");
}

// A corner of 100,000 brackets ended server and command line: the refusal wrote the value into its text, a call a level.
TEST(ShardMap, RefusesADeepTextAndQuotesNoLongOnes) {
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  const std::string box = R"("low": [null,null,null], "high": [null,null,null]}]})";
  const std::string fault = "the shard map nests deeper than 64 levels";
  EXPECT_EQ(fault_of(R"({"shards": [{"name": "a", "low": [)" + deep + ",null,null]," + box), fault);
  EXPECT_EQ(fault_of(R"({"margin_m": )" + deep + R"(, "shards": [{"name": "a", )" + box), fault);
  const std::string long_text(10'000, 'x');
  EXPECT_LT(fault_of(R"({"margin_m": ")" + long_text + R"(", "shards": []})").size(), 200U);
  EXPECT_LT(fault_of("{\"" + long_text + R"(": 1, "shards": []})").size(), 200U);
  EXPECT_EQ(fault_of(R"({"a\u001bb": 1, "shards": []})"), "the shard map: unknown key 'a?b'");
}

/// A k-d tree's leaves: always a map without gaps. A side moved makes a gap or an overlap.
struct RandomSplit {
  explicit RandomSplit(std::uint64_t seed) : random(seed) { split({{-kFar, -kFar, -kFar}, {kFar, kFar, kFar}}, 5); }

  void split(const ShardBox& box, int depth) {
    if (depth == 0 || (boxes.size() > 1 && random() % 4 == 0)) {
      boxes.push_back(box);
      return;
    }
    const std::size_t axis = random() % 3;
    const double low = std::max(box.low[axis], -100.0);
    const double high = std::min(box.high[axis], 100.0);
    const double at = std::uniform_real_distribution<>(low, high)(random);
    if (!(at > box.low[axis] && at < box.high[axis])) {
      boxes.push_back(box);
      return;
    }
    ShardBox below = box;
    ShardBox above = box;
    below.high[axis] = above.low[axis] = at;
    split(below, depth - 1);
    split(above, depth - 1);
  }

  static std::string corner(const std::array<double, 3>& sides) {
    std::string text;
    for (const double side : sides) {
      char number[40];
      std::snprintf(number, sizeof(number), "%.17g", side);
      text += (text.empty() ? "" : ", ") + (std::isinf(side) ? std::string("null") : std::string(number));
    }
    return '[' + text + ']';
  }

  std::string text() const {
    std::string shards;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      shards += (i > 0 ? ", " : "") + std::string("{\"name\": \"s") + std::to_string(i) +
                "\", \"low\": " + corner(boxes[i].low) + ", \"high\": " + corner(boxes[i].high) + '}';
    }
    return "{\"shards\": [" + shards + "]}";
  }

  std::mt19937_64 random;
  std::vector<ShardBox> boxes;
};

TEST(ShardMap, TakesEverySplitAndNoSplitWithASideMoved) {
  const std::uint64_t seed = 28;
  int moved = 0;
  for (std::uint64_t round = 0; round < 200; ++round) {
    SCOPED_TRACE(seed + round);
    RandomSplit split(seed + round);
    ASSERT_EQ(fault_of(split.text()), "");
    const ShardMap map = ShardMap::parse(split.text());
    std::uniform_real_distribution<> somewhere(-120, 120);
    for (int i = 0; i < 50; ++i) {
      const std::array<double, 3> point{somewhere(split.random), somewhere(split.random), somewhere(split.random)};
      int holders = 0;
      for (const ShardBox& box : split.boxes) holders += meet(box, {point, point}) ? 1 : 0;
      EXPECT_EQ(holders, 1);  // a random point is on no border
      EXPECT_TRUE(meet(map.at(map.owner_of(point)).box, {point, point}));
    }
    for (ShardBox& box : split.boxes) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (std::isinf(box.low[axis])) continue;
        const double before = box.low[axis];
        box.low[axis] += split.random() % 2 == 0 ? 1e-9 : -1e-9;
        if (box.low[axis] < box.high[axis]) {
          EXPECT_NE(fault_of(split.text()), "");
          ++moved;
        }
        box.low[axis] = before;
      }
    }
  }
  EXPECT_GT(moved, 1'000);
}

TEST(ShardMap, HasAFingerprintOfWhatItSays) {
  const std::string text = kHalves;
  EXPECT_EQ(ShardMap::parse(text).fingerprint(), ShardMap::parse(text).fingerprint());
  std::string wider = text;
  wider.replace(wider.find("\"margin_m\": 2"), 13, "\"margin_m\": 3");
  EXPECT_NE(ShardMap::parse(text).fingerprint(), ShardMap::parse(wider).fingerprint());
}

}  // namespace
}  // namespace collided::shards
