// Two worlds are compared wherever both are known at one instant, whichever of the two is heard first.
#include <gtest/gtest.h>

#include <memory>

#include "server/fleet/world_comparison.hpp"

namespace collided::engine::service {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;

class Comparisons : public testing::Test {
 protected:
  static InstantDigest at(std::int64_t second, std::uint64_t sum = 0) {
    InstantDigest made{.time_ns = second * kSecondNs, .digest = {}};
    made.digest.sums[0] = sum;
    return made;
  }
  static std::shared_ptr<const Snapshot> nobody() { return std::make_shared<Snapshot>(); }

  WorldComparison comparison;
};

TEST_F(Comparisons, WhicheverComesFirst) {
  comparison.note_own(at(1), nobody());
  EXPECT_EQ(comparison.compared(), 0U);
  comparison.hear(at(1));
  EXPECT_EQ(comparison.compared(), 1U);
  comparison.hear(at(2));
  comparison.note_own(at(2), nobody());
  EXPECT_EQ(comparison.compared(), 2U);
  EXPECT_EQ(comparison.differing(), 0U);
}

TEST_F(Comparisons, AnInstantCountsOnceHoweverOftenItIsSaid) {
  comparison.note_own(at(1), nobody());
  for (int i = 0; i < 3; ++i) comparison.hear(at(1, 7));
  EXPECT_EQ(comparison.compared(), 1U);
  EXPECT_EQ(comparison.differing(), 1U);
  EXPECT_EQ(comparison.differed_at_ns(), kSecondNs);
}

TEST_F(Comparisons, DifferencesInARowAreCountedAndAnEqualInstantEndsThem) {
  for (std::int64_t second = 1; second <= 3; ++second) {
    comparison.note_own(at(second, 1), nobody());
    comparison.hear(at(second, 2));
  }
  EXPECT_EQ(comparison.differing(), 3U);
  comparison.note_own(at(4, 1), nobody());
  comparison.hear(at(4, 1));
  EXPECT_EQ(comparison.differing(), 0U);
}

// The last groups have what commands brought, which one of the two may do a moment later.
TEST_F(Comparisons, TellWhetherObjectsOfPublishersDiffer) {
  InstantDigest command = at(1);
  command.digest.sums.back() = 3;
  comparison.note_own(command, nobody());
  comparison.hear(at(1));
  EXPECT_EQ(comparison.differing(), 1U);
  EXPECT_TRUE(comparison.only_unpublished_differed());
  comparison.note_own(at(2, 1), nobody());
  comparison.hear(at(2, 2));
  EXPECT_FALSE(comparison.only_unpublished_differed());
}

// What the one that was followed before has said is no word of the one that has taken its place.
TEST_F(Comparisons, WithAnotherServerOnlyWhatThatOneSaysCounts) {
  comparison.note_own(at(1, 1), nobody());
  comparison.hear(at(1, 2));
  comparison.hear(at(2, 1));
  comparison.begin_anew();
  EXPECT_EQ(comparison.differing(), 0U);
  comparison.note_own(at(2, 1), nobody());
  EXPECT_EQ(comparison.compared(), 1U);
  comparison.hear(at(2, 1));
  EXPECT_EQ(comparison.compared(), 2U);
}

TEST_F(Comparisons, InstantsThatOnlyOneHasAreNotCompared) {
  comparison.note_own(at(1, 1), nobody());
  comparison.note_own(at(3, 1), nobody());
  comparison.hear(at(2, 2));
  comparison.hear({});
  EXPECT_EQ(comparison.compared(), 0U);
  comparison.hear(at(3, 1));
  EXPECT_EQ(comparison.compared(), 1U);
  EXPECT_EQ(comparison.differing(), 0U);
}

}  // namespace
}  // namespace collided::engine::service
