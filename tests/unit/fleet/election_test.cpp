// The thread of an election: who may serve, and what is said when it may not.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "server/fleet/authority/election.hpp"
#include "tests/unit/fleet/fake_lease_store.hpp"

namespace collided::engine::service {
namespace {

using namespace std::chrono_literals;
using test::FakeLeaseStore;

/// One store for several elections. Its clock stands still: no lease ends by itself.
class SharedStore : public etcd::LeaseStore {
 public:
  explicit SharedStore(FakeLeaseStore& store) : store_(store) {}
  std::int64_t grant(int life_s) override { return store_.grant(life_s); }
  bool renew(std::int64_t lease) override { return store_.renew(lease); }
  void revoke(std::int64_t lease) override { store_.revoke(lease); }
  etcd::StoreResult transact(const etcd::StoreTransaction& transaction) override {
    return store_.transact(transaction);
  }

 private:
  FakeLeaseStore& store_;
};

class ElectionTest : public ::testing::Test {
 protected:
  struct Server {
    ServingTerm term;
    std::mutex mutex;
    std::string said;
    std::unique_ptr<Election> election;
    void say(const std::string& sentence) {
      const std::lock_guard lock(mutex);
      said += sentence + "\n";
    }
    bool has_said(const std::string& part) {
      const std::lock_guard lock(mutex);
      return said.find(part) != std::string::npos;
    }
  };
  std::unique_ptr<Server> server(const std::string& name, TakeOverMode mode = TakeOverMode::strict) {
    auto made = std::make_unique<Server>();
    made->election = std::make_unique<Election>(
        std::make_unique<SharedStore>(store_),
        ElectionOptions{.store = "store", .prefix = "plant", .life_s = 1, .description = name, .mode = mode},
        made->term, [one = made.get()](const std::string& sentence) { one->say(sentence); });
    return made;
  }
  void connect(Server& one) {
    one.election->connect([&one](const std::string& why) { one.say("successor: " + why); });
  }
  template <class Condition>
  static bool comes_true(Condition&& condition) {
    const auto until = std::chrono::steady_clock::now() + 20s;
    while (!condition() && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(2ms);
    return condition();
  }

  FakeLeaseStore store_;
};

TEST_F(ElectionTest, TheTermIsOverBeforeThePlaceIsWonAndIsRenewedAfter) {
  const auto north = server("north");
  EXPECT_TRUE(north->term.is_over());
  EXPECT_EQ(north->election->begin(7), 7U);
  EXPECT_TRUE(north->term.is_over());
  north->election->win();
  const std::int64_t until_ns = north->term.until_ns();
  EXPECT_TRUE(comes_true([&] { return north->term.until_ns() > until_ns + 500'000'000; }));
  north->election->close();
  EXPECT_TRUE(north->term.is_over());
  EXPECT_FALSE(store_.value("plant/place"));
}

TEST_F(ElectionTest, WithTheStoreAwayItFallsSilentAndSaysSoAndGoesOn) {
  const auto north = server("north");
  north->election->begin(7);
  north->election->win();
  connect(*north);
  store_.fail(FakeLeaseStore::Fault::before, true);
  EXPECT_TRUE(comes_true([&] { return north->has_said("publishes and answers nothing until it is"); }));
  EXPECT_TRUE(north->term.is_over());
  EXPECT_EQ(north->election->problem(),
            "silent, since its place as the primary is not confirmed: store: the store is away");
  store_.fail(FakeLeaseStore::Fault::none);
  EXPECT_TRUE(comes_true([&] { return north->has_said("is confirmed again: it goes on"); }));
  EXPECT_TRUE(comes_true([&] { return !north->term.is_over(); }));
  EXPECT_EQ(north->election->problem(), "");
  EXPECT_FALSE(north->has_said("successor"));
}

TEST_F(ElectionTest, WhoseStoreAnswersNothingIsNotElected) {
  const auto north = server("north");
  store_.fail(FakeLeaseStore::Fault::before, true);
  EXPECT_THROW(north->election->begin(7), CannotServeNow);
  store_.fail(FakeLeaseStore::Fault::none);
  north->election->begin(7);
  const auto south = server("south");
  south->election->begin(7);
  south->election->win();
  EXPECT_THROW(north->election->win(), CannotServeNow);
  EXPECT_TRUE(north->has_said("south is the primary; waiting for its lease to end"));
}

TEST_F(ElectionTest, AStandbyTakesThePlaceOnceAskedAndTheOtherOneIsTold) {
  const auto north = server("north"), south = server("south", TakeOverMode::fast);
  const std::uint64_t epoch = north->election->begin(7);
  south->election->begin(7);
  north->election->win();
  connect(*north);
  connect(*south);
  EXPECT_FALSE(south->election->has_place());
  EXPECT_TRUE(comes_true([&] { return south->election->succeeds(epoch); }));
  EXPECT_FALSE(south->term.is_over());
  EXPECT_TRUE(comes_true([&] { return north->has_said("successor: south (epoch 8) has this server's place"); }));
  EXPECT_TRUE(north->term.is_over());
}

// The one that draws first is left behind by the other, and follows it with a greater epoch.
TEST_F(ElectionTest, AStandbyThatDrawsAgainMayTakeThePlaceOfWhoHadTheGreaterEpoch) {
  const auto north = server("north"), west = server("west", TakeOverMode::fast);
  const auto south = server("south", TakeOverMode::fast);
  const std::uint64_t first = north->election->begin(7);
  west->election->begin(7);
  const std::uint64_t second = south->election->begin(7);
  north->election->win();
  connect(*south);
  connect(*west);
  EXPECT_TRUE(comes_true([&] { return south->election->succeeds(first); }));
  EXPECT_TRUE(comes_true([&] { return !west->election->succeeds(second) && !west->election->problem().empty(); }))
      << "its epoch is lower";
  EXPECT_FALSE(south->election->draw_again(0)) << "it has the place with the epoch that it had";
  store_.fail(FakeLeaseStore::Fault::before, true);
  EXPECT_FALSE(west->election->draw_again(second + 1));
  EXPECT_NE(west->election->problem(), "");
  store_.fail(FakeLeaseStore::Fault::none);
  EXPECT_EQ(west->election->draw_again(second + 5), second + 5);
  EXPECT_TRUE(comes_true([&] { return west->election->succeeds(second); }));
  EXPECT_TRUE(comes_true([&] { return south->term.is_over(); }));
}

TEST_F(ElectionTest, WhatHappenedBeforeItWasConnectedIsTold) {
  const auto north = server("north"), south = server("south", TakeOverMode::fast);
  const std::uint64_t epoch = north->election->begin(7);
  south->election->begin(7);
  north->election->win();
  connect(*south);
  EXPECT_TRUE(comes_true([&] { return south->election->succeeds(epoch); }));
  EXPECT_TRUE(comes_true([&] { return north->term.is_over() && !north->election->has_place(); }));
  connect(*north);
  EXPECT_TRUE(comes_true([&] { return north->has_said("successor: "); }));
}

TEST_F(ElectionTest, APlaceThatIsLentComesBackUnlessAnotherOneTookIt) {
  const auto north = server("north"), south = server("south");
  const std::uint64_t epoch = north->election->begin(7);
  south->election->begin(7);
  north->election->win();
  connect(*north);
  connect(*south);
  north->election->lend();
  EXPECT_TRUE(north->term.is_over());
  EXPECT_TRUE(north->election->take_back());
  EXPECT_FALSE(north->term.is_over());
  north->election->lend();
  EXPECT_TRUE(comes_true([&] { return south->election->succeeds(epoch); }));
  EXPECT_FALSE(north->election->take_back());
  EXPECT_TRUE(north->term.is_over());
  EXPECT_FALSE(north->has_said("successor")) << "it was asked to";
}

}  // namespace
}  // namespace collided::engine::service
