// The map of a world in a store of keys: of those who write it one wins, whatever fails on the way.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "idl/shards/shard_map_store.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/unit/fleet/fake_lease_store.hpp"

namespace collided::shards {
namespace {

using namespace std::chrono_literals;
using engine::service::test::FakeLeaseStore;
using Which = ShardMapStore::Which;

ShardMap halves_at(double x) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  return ShardMap::of(1, {{"west", {{-kEndless, -kEndless, -kEndless}, {x, kEndless, kEndless}}},
                          {"east", {{x, -kEndless, -kEndless}, {kEndless, kEndless, kEndless}}}});
}

class MapStoreTest : public testing::Test {
 protected:
  /// Who of several that use the same keys.
  std::unique_ptr<ShardMapStore> user(std::chrono::nanoseconds patience = 150ms) {
    struct Shared : etcd::LeaseStore {
      explicit Shared(FakeLeaseStore& shared) : store(shared) {}
      std::int64_t grant(int life_s) override { return store.grant(life_s); }
      bool renew(std::int64_t lease) override { return store.renew(lease); }
      void revoke(std::int64_t lease) override { store.revoke(lease); }
      etcd::StoreResult transact(const etcd::StoreTransaction& asked) override { return store.transact(asked); }
      FakeLeaseStore& store;
    };
    return std::make_unique<ShardMapStore>(std::make_unique<Shared>(keys_), "yard", "etcd://a:1/yard", patience);
  }
  std::string failure(ShardMapStore& store) {
    try {
      static_cast<void>(store.read());
    } catch (const ShardMapError& wrong) { return wrong.what(); }
    return "none";
  }

  FakeLeaseStore keys_;
};

TEST_F(MapStoreTest, OfTwoWhoWriteOneWins) {
  const auto one = user();
  const auto other = user();
  EXPECT_FALSE(one->read());
  const auto first = one->write(halves_at(1), 0);
  ASSERT_TRUE(first);
  EXPECT_FALSE(other->write(halves_at(2), 0)) << "there is a map by now";
  EXPECT_EQ(other->write(halves_at(1), 0), first) << "the same map is no other one";
  const auto second = other->write(halves_at(2), *first);
  ASSERT_TRUE(second);
  EXPECT_GT(*second, *first);
  EXPECT_FALSE(one->write(halves_at(3), *first)) << "its revision is gone";
  EXPECT_EQ(one->read()->map.fingerprint(), halves_at(2).fingerprint());
  EXPECT_EQ(one->read()->revision, *second);
}

TEST_F(MapStoreTest, ASuccessorKeepsTheMapBefore) {
  const auto one = user();
  const auto other = user();
  ASSERT_TRUE(one->write(halves_at(1), 0));
  const std::optional<KeptShardMap> seen = one->read();
  const std::optional<KeptShardMap> also_seen = other->read();
  ASSERT_TRUE(one->succeed(*seen, halves_at(2)));
  EXPECT_FALSE(other->succeed(*also_seen, halves_at(3)));
  EXPECT_EQ(one->read()->map.fingerprint(), halves_at(2).fingerprint());
  EXPECT_EQ(one->read(Which::before)->map.fingerprint(), halves_at(1).fingerprint());
  EXPECT_FALSE(one->read(Which::next));
}

TEST_F(MapStoreTest, WhatIsNoMapIsRefusedWithKeyAndRevision) {
  const auto store = user();
  keys_.set("yard", "west and east");
  EXPECT_EQ(failure(*store), "etcd://a:1/yard: key 'yard', revision 1: the shard map is no JSON object");
  keys_.set("yard", R"({"shards": [{"name": "west", "low": [null, null, null], "high": [0, null, null]}]})");
  EXPECT_EQ(failure(*store).find("etcd://a:1/yard: key 'yard', revision 2: no shard holds what is at ("), 0U)
      << failure(*store);
  EXPECT_EQ(store->revision(), 2);
}

TEST_F(MapStoreTest, AnAddressWithoutAKeyIsNone) {
  for (const char* bad : {"etcd://a:1", "etcd://a:1/", "etcd://a/yard", "map.json"})
    EXPECT_THROW(ShardMapStore(bad, {.etcd_keys = {}, .patience = 1s}), ShardMapError) << bad;
}

TEST_F(MapStoreTest, AStoreThatIsAwayIsAskedAgainForSomeTime) {
  const auto store = user();
  keys_.fail(FakeLeaseStore::Fault::before);
  EXPECT_FALSE(store->read()) << "the second try is answered";
  keys_.fail(FakeLeaseStore::Fault::before, true);
  EXPECT_EQ(failure(*store), "etcd://a:1/yard: etcd does not answer: the store is away");
  EXPECT_THROW(store->write(halves_at(1), 0), MapStoreAway);
}

// Whoever is told that his map is there has put it in the place of the one that he had seen, whichever answers were lost.
TEST_F(MapStoreTest, EachMapTakesThePlaceOfTheOneThatItsWriterSaw) {
  std::mt19937_64 random = oracle::seeded(28);
  struct Writer {
    std::unique_ptr<ShardMapStore> store;
    std::optional<KeptShardMap> seen;
  };
  std::vector<Writer> writers;
  for (int i = 0; i < 3; ++i) writers.push_back({.store = user(0ms), .seen = {}});
  ASSERT_TRUE(writers[0].store->write(halves_at(0), 0));
  std::uint64_t holds = halves_at(0).fingerprint();  // as those who won say
  std::size_t won = 0;
  std::size_t lost = 0;
  for (int i = 1; i < 3'000; ++i) {
    Writer& writer = writers[random() % writers.size()];
    const bool is_answered = random() % 4 != 0;
    if (random() % 2 == 0) {
      writer.seen = writer.store->read();
      EXPECT_EQ(writer.seen->map.fingerprint(), holds) << i;
      continue;
    }
    if (!writer.seen) continue;
    if (!is_answered) keys_.fail(random() % 2 == 0 ? FakeLeaseStore::Fault::before : FakeLeaseStore::Fault::after);
    const ShardMap next = halves_at(i);
    const bool is_up_to_date = writer.seen->map.fingerprint() == holds;
    try {
      const bool is_there = writer.store->succeed(*writer.seen, next).has_value();
      EXPECT_EQ(is_there, is_up_to_date) << i;
      (is_there ? won : lost) += 1;
    } catch (const MapStoreAway&) {}  // it may be there, and may not
    holds = writer.store->read()->map.fingerprint();
    EXPECT_TRUE(is_up_to_date || holds != next.fingerprint()) << i;
  }
  EXPECT_GT(won, 100U);
  EXPECT_GT(lost, 100U);
}

}  // namespace
}  // namespace collided::shards
