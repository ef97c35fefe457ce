// The clearance of groups of objects beside every part of every object with every other.
#include <gtest/gtest.h>

#include <algorithm>

#include "server/world/groups/clearance.hpp"
#include "tests/oracle/group_oracle.hpp"
#include "tests/oracle/mixed_world.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

using oracle::PlainClearance;

std::vector<ObjectId> all_of(const Snapshot& snapshot) {
  std::vector<ObjectId> ids;
  for (const auto& info : snapshot.objects) {
    if (info) ids.push_back(info->id);
  }
  return ids;
}

/// Every object of some share, at random.
std::vector<ObjectId> some_of(const std::vector<ObjectId>& ids, double share, std::mt19937_64& random) {
  std::vector<ObjectId> chosen;
  std::bernoulli_distribution is_chosen(share);
  std::copy_if(ids.begin(), ids.end(), std::back_inserter(chosen), [&](ObjectId) { return is_chosen(random); });
  return chosen;
}

/// The numbers of both are bounds on one truth, so they meet.
void expect_same(const MemberPair& found, const PlainClearance& plain) {
  EXPECT_EQ(found.clearance.touches == Decision::yes, plain.touches);
  EXPECT_LE(found.clearance.low_m(), plain.high_m);
  EXPECT_GE(found.clearance.high_m(), plain.low_m);
}

const PlainClearance& twin_of(const MemberPair& found, const std::vector<PlainClearance>& plain) {
  const auto twin = std::find_if(plain.begin(), plain.end(), [&](const PlainClearance& pair) {
    return (pair.a == found.a && pair.b == found.b) || (pair.a == found.b && pair.b == found.a);
  });
  EXPECT_NE(twin, plain.end()) << "a pair that may not be told";
  return twin == plain.end() ? plain.front() : *twin;
}

class GroupClearanceTest : public testing::Test {
 protected:
  GroupClearance asked(const ClearanceAsk& ask) { return clearance_of(*world_.world.newest(), ask, part_meshes_); }

  std::mt19937_64 random_ = oracle::seeded(5);
  oracle::MixedWorld world_{random_};
  PartMeshes part_meshes_;
};

TEST_F(GroupClearanceTest, NearestPairsAreThoseOfEveryPairOfParts) {
  const auto state = world_.world.newest();
  for (int round = 0; round < 12; ++round) {
    ClearanceAsk ask{.from = some_of(all_of(*state), 0.3, random_),
                     .to = some_of(all_of(*state), round % 2 == 0 ? 0.05 : 0.4, random_),
                     .most = std::size_t{1} << round % 4 * 2,
                     .with_filtered = round % 3 == 0};
    const auto plain = oracle::plain_clearances(*state, ask.from, ask.to, ask.with_filtered);
    const GroupClearance found = asked(ask);
    ASSERT_EQ(found.pairs.size(), std::min(ask.most, plain.size()));
    for (std::size_t i = 0; i < found.pairs.size(); ++i) {
      expect_same(found.pairs[i], twin_of(found.pairs[i], plain));
      // The i-th nearest is about as near as the twin's, whichever pair it is.
      EXPECT_LE(found.pairs[i].clearance.low_m(), plain[i].high_m);
      EXPECT_GE(found.pairs[i].clearance.high_m(), plain[i].low_m);
    }
    const bool any = std::any_of(plain.begin(), plain.end(), [](const auto& pair) { return pair.touches; });
    EXPECT_EQ(found.touches, any ? Decision::yes : Decision::no);
  }
}

TEST_F(GroupClearanceTest, WithinADistanceAreAllPairsAndNoOthers) {
  const auto state = world_.world.newest();
  for (const double within_m : {0.0, 0.05, 0.4}) {
    const ClearanceAsk ask{.from = all_of(*state), .to = all_of(*state), .within_m = within_m, .most = 100'000};
    const auto plain = oracle::plain_clearances(*state, ask.from, ask.to, false);
    const GroupClearance found = asked(ask);
    const auto surely =
        std::count_if(plain.begin(), plain.end(), [&](const auto& pair) { return pair.high_m <= within_m; });
    const auto perhaps =
        std::count_if(plain.begin(), plain.end(), [&](const auto& pair) { return pair.low_m <= within_m; });
    EXPECT_GT(surely, 10) << "the world is too empty for this test";
    EXPECT_GE(found.pairs.size(), static_cast<std::size_t>(surely));
    EXPECT_LE(found.pairs.size(), static_cast<std::size_t>(perhaps));
    for (const MemberPair& pair : found.pairs) expect_same(pair, twin_of(pair, plain));
    EXPECT_LT(found.tested, plain.size()) << "all pairs were tested";
  }
}

TEST_F(GroupClearanceTest, MovedMeshesAndBallsAboveTheFloorAreAsFarAsEveryPairOfParts) {
  world_.add_half_spaces();
  const auto state = world_.world.newest();
  std::vector<ObjectId> grounds;
  std::vector<ObjectId> others;
  for (const ObjectId id : all_of(*state)) {
    const bool is_ground = state->objects[slot_of(id)]->name.starts_with("half_space");
    (is_ground ? grounds : others).push_back(id);
  }
  ASSERT_EQ(grounds.size(), 2u);
  for (const std::vector<ObjectId>& ground : {std::vector{grounds[0]}, std::vector{grounds[1]}}) {
    const ClearanceAsk ask{.from = others, .to = ground, .most = 1'000};
    const auto plain = oracle::plain_clearances(*state, ask.from, ask.to, false);
    const GroupClearance found = asked(ask);
    ASSERT_EQ(found.pairs.size(), plain.size());
    for (const MemberPair& pair : found.pairs) expect_same(pair, twin_of(pair, plain));
  }
}

TEST_F(GroupClearanceTest, TurningTheGroupsTurnsTheAnswerAndNothingElse) {
  const auto state = world_.world.newest();
  const std::vector<ObjectId> some = some_of(all_of(*state), 0.2, random_);
  const std::vector<ObjectId> others = some_of(all_of(*state), 0.2, random_);
  const GroupClearance there = asked({.from = some, .to = others});
  const GroupClearance back = asked({.from = others, .to = some});
  ASSERT_EQ(there.pairs.size(), 1u);
  ASSERT_EQ(back.pairs.size(), 1u);
  EXPECT_LE(there.pairs[0].clearance.low_m(), back.pairs[0].clearance.high_m());
  EXPECT_GE(there.pairs[0].clearance.high_m(), back.pairs[0].clearance.low_m());
}

TEST_F(GroupClearanceTest, EmptyGroupsAndOneObjectAloneHaveNoPair) {
  const auto state = world_.world.newest();
  const ObjectId one = all_of(*state).front();
  EXPECT_TRUE(asked({.from = {}, .to = all_of(*state)}).pairs.empty());
  EXPECT_TRUE(asked({.from = {one}, .to = {one}}).pairs.empty());
}

TEST_F(GroupClearanceTest, ADeadlineThatIsOverLeavesTheAnswerOpen) {
  const auto state = world_.world.newest();
  const GroupClearance found = asked({.from = all_of(*state), .to = all_of(*state), .deadline_ns = 1});
  EXPECT_TRUE(found.is_late);
  EXPECT_EQ(found.touches, Decision::undecided);
}

}  // namespace
}  // namespace collided::engine
