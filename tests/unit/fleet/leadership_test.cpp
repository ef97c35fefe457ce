// Of several servers at most one may serve, whatever becomes of the store's answers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "server/fleet/authority/leadership.hpp"
#include "tests/unit/fleet/fake_lease_store.hpp"

namespace collided::engine::service {
namespace {

using test::FakeLeaseStore;
using PlaceState = Leadership::PlaceState;

constexpr std::int64_t kStoreSecondNs = 1'000'000'000;
constexpr int kLife_s = 3;

class LeadershipTest : public ::testing::Test {
 protected:
  std::unique_ptr<Leadership> server(std::uint64_t least = 100) {
    auto made = std::make_unique<Leadership>(store_, "plant", kLife_s, "'north'", [this] { return store_.now_ns(); });
    made->draw_epoch(least);
    return made;
  }
  bool may_serve(const Leadership& one) const { return store_.now_ns() < one.confirmed_until_ns(); }

  FakeLeaseStore store_;
};

TEST_F(LeadershipTest, EpochsGrowWhoeverDrawsThemAndAreNeverBelowTheLeast) {
  EXPECT_EQ(server(100)->epoch(), 100U);
  EXPECT_EQ(server(50)->epoch(), 101U);
  EXPECT_EQ(server(1'800'000'000)->epoch(), 1'800'000'000U);
  EXPECT_EQ(server(100)->epoch(), 1'800'000'001U);
}

// Somebody has deleted the counter: what was taken last still counts.
TEST_F(LeadershipTest, AnEpochIsAboveTheOneThatHadThePlaceThoughTheCounterIsLost) {
  const auto north = server(500);
  ASSERT_EQ(north->take(), PlaceState::held);
  FakeLeaseStore emptied;
  emptied.set("plant/last", *store_.value("plant/last"));
  Leadership south(emptied, "plant", kLife_s, "", [] { return std::int64_t{1}; });
  EXPECT_EQ(south.draw_epoch(100), 501U);
}

TEST_F(LeadershipTest, OfTwoOneHasThePlaceForAThirdOfTheLeaseAtATime) {
  const auto north = server(), south = server();
  EXPECT_EQ(north->take(), PlaceState::held);
  EXPECT_EQ(south->take(), PlaceState::others);
  EXPECT_EQ(south->holder(), "'north'");
  EXPECT_TRUE(may_serve(*north));
  EXPECT_FALSE(may_serve(*south));
  store_.advance(kStoreSecondNs);
  EXPECT_FALSE(may_serve(*north));
  EXPECT_EQ(north->confirm(), PlaceState::held);
  EXPECT_TRUE(may_serve(*north));
}

TEST_F(LeadershipTest, StrictWaitsForTheLeaseAndThenTheOldOneHasLostThePlaceForGood) {
  const auto north = server(), south = server();
  ASSERT_EQ(north->take(), PlaceState::held);
  store_.advance(kLife_s * kStoreSecondNs - 1);
  EXPECT_EQ(south->succeed(north->epoch(), TakeOverMode::strict), PlaceState::others);
  store_.advance(1);
  EXPECT_EQ(south->succeed(north->epoch(), TakeOverMode::strict), PlaceState::held);
  EXPECT_EQ(north->confirm(), PlaceState::passed);
  EXPECT_EQ(north->take(), PlaceState::passed);
  EXPECT_FALSE(may_serve(*north));
}

TEST_F(LeadershipTest, FastTakesThePlaceAtOnceAndTheOldOneLearnsWhenItAsks) {
  const auto north = server(), south = server();
  ASSERT_EQ(north->take(), PlaceState::held);
  EXPECT_EQ(south->succeed(north->epoch(), TakeOverMode::fast), PlaceState::held);
  EXPECT_TRUE(may_serve(*north)) << "the window that the guide tells of";
  EXPECT_EQ(north->confirm(), PlaceState::passed);
  store_.advance(kStoreSecondNs);
  EXPECT_FALSE(may_serve(*north));
  EXPECT_EQ(south->confirm(), PlaceState::held);
}

// Both have followed north, and the second one has not seen that the first one took its place.
TEST_F(LeadershipTest, OfTwoThatSucceedTheSameOneTheSecondIsRefused) {
  for (const TakeOverMode mode : {TakeOverMode::strict, TakeOverMode::fast}) {
    const auto north = server(), south = server(), west = server();
    ASSERT_EQ(north->take(), PlaceState::held);
    north->resign();
    EXPECT_EQ(south->succeed(north->epoch(), mode), PlaceState::held);
    EXPECT_EQ(west->succeed(north->epoch(), mode), PlaceState::passed);
    EXPECT_EQ(south->confirm(), PlaceState::held);
    south->resign();
    EXPECT_EQ(west->succeed(north->epoch(), mode), PlaceState::passed) << "it does not have south's world";
    west->resign();
  }
}

TEST_F(LeadershipTest, WhoseLeaseEndedUnseenHasThePlaceAgainAsLongAsNobodyTookIt) {
  const auto north = server(), south = server();
  ASSERT_EQ(north->take(), PlaceState::held);
  store_.advance(2 * kLife_s * kStoreSecondNs);
  ASSERT_FALSE(store_.value("plant/place"));
  EXPECT_EQ(north->confirm(), PlaceState::held);
  store_.advance(2 * kLife_s * kStoreSecondNs);
  ASSERT_EQ(south->take(), PlaceState::held);
  south->resign();
  EXPECT_EQ(north->confirm(), PlaceState::passed) << "nobody has it, but somebody had it since";
}

// The key that is still there would go with the old lease, whatever became of a new one.
TEST_F(LeadershipTest, APlaceThatCouldNotBeGivenUpIsHeldByTheSameLease) {
  const auto north = server(), south = server();
  ASSERT_EQ(north->take(), PlaceState::held);
  store_.fail(FakeLeaseStore::Fault::before);
  EXPECT_THROW(north->resign(), etcd::StoreError);
  EXPECT_FALSE(may_serve(*north));
  store_.advance(kLife_s * kStoreSecondNs - 1);
  EXPECT_EQ(north->take(), PlaceState::held);
  store_.advance(1);
  EXPECT_EQ(south->succeed(north->epoch(), TakeOverMode::strict), PlaceState::others);
  EXPECT_TRUE(may_serve(*north));
}

TEST_F(LeadershipTest, AStoreThatHasLostAllSaysSo) {
  const auto north = server();
  ASSERT_EQ(north->take(), PlaceState::held);
  store_.clear();
  EXPECT_EQ(north->confirm(), PlaceState::free);
  EXPECT_EQ(north->last_epoch(), 0U);
}

TEST_F(LeadershipTest, WhatIsNoEpochIsRefused) {
  const auto north = server();
  store_.set("plant/last", "99999");
  EXPECT_THROW(north->look(), etcd::StoreError);
  store_.set("plant/last", "000000000000000000a9");
  EXPECT_THROW(north->confirm(), etcd::StoreError);
}

/// Servers that ask, are slow, lose answers, die and start again, in random order; each may serve until its newest
/// confirmation ends.
class RandomElections {
 public:
  RandomElections(std::uint64_t seed, TakeOverMode mode) : random_(seed), mode_(mode) {
    for (int i = 0; i < 4; ++i) servers_.push_back(fresh());
  }
  void step() {
    const std::size_t at = random_() % servers_.size();
    store_.fail(random_() % 4 != 0   ? FakeLeaseStore::Fault::none
                : random_() % 2 == 0 ? FakeLeaseStore::Fault::before
                                     : FakeLeaseStore::Fault::after);
    try {
      act(*servers_[at]);
      if (random_() % 40 == 0) servers_[at] = fresh();
    } catch (const etcd::StoreError&) {}
    store_.fail(FakeLeaseStore::Fault::none);
    check();
    store_.advance(static_cast<std::int64_t>(random_() % 4 == 0 ? random_() % (4 * kStoreSecondNs)
                                                                : random_() % (kStoreSecondNs / 4)));
  }
  int served() const { return served_; }
  int changes() const { return changes_; }

 private:
  std::unique_ptr<Leadership> fresh() {
    auto made = std::make_unique<Leadership>(store_, "plant", kLife_s, "", [this] { return store_.now_ns(); });
    for (;;) {
      try {
        EXPECT_GT(made->draw_epoch(random_() % 50), newest_);
        newest_ = made->epoch();
        return made;
      } catch (const etcd::StoreError&) {}
    }
  }
  void act(Leadership& one) {
    switch (random_() % 4) {
      case 0: one.take(); break;
      case 1: one.succeed(serving_, mode_); break;
      case 2: one.confirm(); break;
      default:
        if (random_() % 8 == 0) one.resign();
        else one.look();
    }
  }
  void check() {
    int serving = 0;
    std::uint64_t greatest = serving_;
    for (const auto& one : servers_) {
      const std::int64_t until_ns = one->confirmed_until_ns();
      ASSERT_LE(until_ns - store_.now_ns(), kLife_s * kStoreSecondNs / 3);
      const bool is_confirmed_anew = until_ns > std::exchange(confirmed_[one->epoch()], until_ns);
      ASSERT_TRUE(!is_confirmed_anew || one->epoch() >= serving_) << "it was replaced";
      if (is_confirmed_anew) greatest = std::max(greatest, one->epoch());
      serving += until_ns > store_.now_ns() ? 1 : 0;
    }
    ASSERT_TRUE(mode_ == TakeOverMode::fast || serving <= 1);
    served_ += serving > 0 ? 1 : 0;
    changes_ += greatest != std::exchange(serving_, greatest) ? 1 : 0;
  }

  std::mt19937_64 random_;
  const TakeOverMode mode_;
  FakeLeaseStore store_;
  std::vector<std::unique_ptr<Leadership>> servers_;
  std::map<std::uint64_t, std::int64_t> confirmed_;  // until when, by epoch
  std::uint64_t newest_ = 0;
  std::uint64_t serving_ = 0;
  int served_ = 0;
  int changes_ = 0;
};

TEST(LeadershipInRandomOrder, AtMostOneServesAndNoneThatWasReplaced) {
  const char* given = std::getenv("COLLIDED_SEED");
  const std::uint64_t first = given ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  const char* rounds = std::getenv("COLLIDED_ELECTIONS");
  const std::uint64_t end = first + (rounds ? std::strtoull(rounds, nullptr, 10) : 40);
  for (std::uint64_t seed = first; seed < end; ++seed) {
    SCOPED_TRACE("COLLIDED_SEED=" + std::to_string(seed));
    for (const TakeOverMode mode : {TakeOverMode::strict, TakeOverMode::fast}) {
      RandomElections elections(seed, mode);
      for (int i = 0; i < 2'000 && !::testing::Test::HasFatalFailure(); ++i) elections.step();
      if (::testing::Test::HasFatalFailure()) return;
      EXPECT_GT(elections.served(), 200) << "else nothing was tested";
      EXPECT_GT(elections.changes(), 10);
    }
  }
}

}  // namespace
}  // namespace collided::engine::service
