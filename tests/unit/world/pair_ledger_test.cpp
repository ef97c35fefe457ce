// What a block reads of a pair after it has written, before the ledger has any of it.
#include <gtest/gtest.h>

#include "server/world/step/pair_ledger.hpp"
#include "tests/oracle/seed.hpp"

namespace collided::engine {
namespace {

class PairLedgerTwin : public ::testing::Test {
 protected:
  FoundContact found() {
    FoundContact contact{.a = kA, .b = kB, .contact = {}};
    contact.a_triangle = static_cast<std::uint32_t>(random_() % 5);
    contact.contact.depth_m = 1e-3 * static_cast<double>(random_() % 100);
    contact.bracket_low_s = 1e-3 * static_cast<double>(1 + random_() % 9);
    contact.bracket_high_s = contact.bracket_low_s / 2;
    contact.contained = static_cast<Contained>(random_() % 3);
    return contact;
  }
  /// Writes what a decision may write of a pair in this state.
  template <class Ledger>
  void write_one(Ledger& ledger, unsigned choice, const FoundContact& what) {
    const bool holds = ledger.holds(kA, kB);
    if (choice == 0) ledger.touches(what);
    if (choice == 1 && holds) ledger.parts(kA, kB, EndReason::separated, what.bracket_low_s, what.bracket_high_s);
    if (choice == 2 && holds)
      ledger.changes_containment(kA, kB, what.contained, {EndReason::none, what.bracket_low_s, what.bracket_high_s});
    if (choice == 3) ledger.doubts(what, Doubt::numeric);
    if (choice == 4) ledger.doubted_and_parted(what, Doubt::cost_limit);
    if (choice == 5) ledger.decided_apart(kA, kB, what.bracket_low_s, what.bracket_high_s);
    if (choice == 6 && !holds) ledger.touched_and_parted(what);
  }
  static void expect_same(const PairLedger& block, const ContactLedger& ledger) {
    EXPECT_EQ(block.holds(kA, kB), ledger.holds(kA, kB));
    EXPECT_EQ(block.is_in_doubt(kA, kB), ledger.is_in_doubt(kA, kB));
    EXPECT_EQ(block.is_open(kA, kB), ledger.is_open(kA, kB));
    EXPECT_EQ(block.contained(kA, kB), ledger.contained(kA, kB));
    const OpenContact* mine = block.find(kA, kB);
    const OpenContact* theirs = ledger.find(kA, kB);
    ASSERT_EQ(mine == nullptr, theirs == nullptr);
    if (mine == nullptr) return;
    EXPECT_EQ(mine->doubt, theirs->doubt);
    EXPECT_EQ(mine->a_triangle, theirs->a_triangle);
    EXPECT_EQ(mine->contact.depth_m, theirs->contact.depth_m);
    EXPECT_EQ(mine->began_ns, theirs->began_ns);
  }

  static constexpr ObjectId kA = 3, kB = 8;
  std::mt19937_64 random_ = oracle::seeded(33);
};

TEST_F(PairLedgerTwin, ReadsAfterItsWritesWhatTheLedgerReadsAfterThem) {
  for (int world = 0; world < 200; ++world) {
    ContactLedger at_once;
    ContactLedger later;
    const bool has_rules = world % 5 == 0;
    for (ContactLedger* ledger : {&at_once, &later}) {
      if (has_rules) ledger->set_allowed([](ObjectId, ObjectId) { return true; });
    }
    for (int step = 0; step < 6; ++step) {
      for (ContactLedger* ledger : {&at_once, &later}) {
        ledger->begin_step(1'000'000 * (step + 1), true);
        if (step == 3 && world % 3 == 0) ledger->lose(kA);
        if (step == 5) ledger->find_again(kA);
      }
      StepBlock block;
      PairLedger recording(later, &block);
      for (int write = 0; write < 3; ++write) {
        const auto choice = static_cast<unsigned>(random_() % 7);
        const FoundContact what = found();
        write_one(at_once, choice, what);
        write_one(recording, choice, what);
        expect_same(recording, at_once);
      }
      for (const LedgerWrite& change : block.writes) write(change, later);
      EXPECT_EQ(at_once.events().size(), later.events().size());
      expect_same(PairLedger(later), at_once);
      at_once.finish_step();
      later.finish_step();
    }
  }
}

}  // namespace
}  // namespace collided::engine
