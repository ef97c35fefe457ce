// Questions that wait for a publisher's sample: which pass, which wait, for how long, and how many.
#include "server/service/questions/write_barriers.hpp"

#include <gtest/gtest.h>

namespace collided::engine::service {
namespace {

AskPointer behind_barrier(std::uint64_t publisher, std::uint64_t sequence, std::int64_t taken_ns = 0,
                          std::int64_t deadline_ns = 0) {
  auto ask = std::make_unique<Ask>();
  ask->query->barrier_publisher = publisher;
  ask->query->barrier_sequence = sequence;
  ask->query->deadline_ns = deadline_ns;
  ask->taken_ns = taken_ns;
  return ask;
}

WriteBarriers::Outcome pass(WriteBarriers& write_barriers, AskPointer ask) { return write_barriers.pass(ask); }

std::size_t overdue(WriteBarriers& write_barriers, std::int64_t now_ns) {
  return write_barriers.take_overdue(now_ns).size();
}

constexpr std::int64_t kMillisecond = 1'000'000;

// Who allows 5 ms for the answer is told after 5 ms that the sample has not come, not after a second.
TEST(WriteBarriers, AQuestionWaitsNoLongerThanItsOwnDeadline) {
  WriteBarriers write_barriers;
  ASSERT_EQ(pass(write_barriers, behind_barrier(7, 5, 100 * kMillisecond, 5 * kMillisecond)),
            WriteBarriers::Outcome::parked);
  EXPECT_EQ(overdue(write_barriers, 105 * kMillisecond), 0U);
  EXPECT_EQ(overdue(write_barriers, 105 * kMillisecond + 1), 1U);
  EXPECT_TRUE(write_barriers.empty());
}

TEST(WriteBarriers, ALongDeadlineOrNoneBuysTheUsualPatienceOnly) {
  for (const std::int64_t deadline_ns : {std::int64_t{0}, 60'000 * kMillisecond}) {
    WriteBarriers write_barriers;
    ASSERT_EQ(pass(write_barriers, behind_barrier(7, 5, 100 * kMillisecond, deadline_ns)),
              WriteBarriers::Outcome::parked);
    EXPECT_EQ(overdue(write_barriers, 100 * kMillisecond + WriteBarriers::kPatienceNs), 0U);
    EXPECT_EQ(overdue(write_barriers, 100 * kMillisecond + WriteBarriers::kPatienceNs + 1), 1U);
  }
}

TEST(WriteBarriers, OnlyWhatIsOverdueIsTakenAndTheRestGoesOnWaiting) {
  WriteBarriers write_barriers;
  for (const std::int64_t deadline_ns : {9, 3, 6}) {
    ASSERT_EQ(pass(write_barriers, behind_barrier(7, 5, 0, deadline_ns * kMillisecond)),
              WriteBarriers::Outcome::parked);
  }
  const std::vector<AskPointer> late = write_barriers.take_overdue(7 * kMillisecond);
  ASSERT_EQ(late.size(), 2U);
  EXPECT_EQ(late[0]->query->deadline_ns, 3 * kMillisecond);
  EXPECT_EQ(late[1]->query->deadline_ns, 6 * kMillisecond);
  write_barriers.update({{7, 5}});
  EXPECT_EQ(write_barriers.take_ready().size(), 1U);
}

TEST(WriteBarriers, WhoNamesNoPublisherPassesAndWhoHasPassedDoesAgain) {
  WriteBarriers write_barriers;
  EXPECT_EQ(pass(write_barriers, behind_barrier(0, 5)), WriteBarriers::Outcome::passed);
  EXPECT_EQ(pass(write_barriers, behind_barrier(7, 0)), WriteBarriers::Outcome::parked) << "nothing is known of it yet";
  write_barriers.update({{7, 1}});
  std::vector<AskPointer> ready = write_barriers.take_ready();
  ASSERT_EQ(ready.size(), 1U);
  // The publisher is forgotten before a worker comes to the question: it has passed all the same.
  write_barriers.update({});
  EXPECT_EQ(pass(write_barriers, std::move(ready[0])), WriteBarriers::Outcome::passed);
}

// One client whose questions waited for a sample that never came had a third of all others' refused.
TEST(WriteBarriers, TheLastPlacesAreForProcessesWithFew) {
  WriteBarriers write_barriers;
  const auto park = [&](std::uint64_t participant, std::size_t count) {
    std::size_t parked = 0;
    for (std::size_t i = 0; i < count; ++i) {
      AskPointer ask = behind_barrier(7, 5);
      ask->from.participant = participant;
      parked += pass(write_barriers, std::move(ask)) == WriteBarriers::Outcome::parked ? 1 : 0;
    }
    return parked;
  };
  EXPECT_EQ(park(1, 2'000), WriteBarriers::kMostOfOne);
  EXPECT_EQ(park(2, 2'000), WriteBarriers::kMost - WriteBarriers::kReserved - WriteBarriers::kMostOfOne);
  for (std::uint64_t other = 3; other < 3 + WriteBarriers::kReserved / WriteBarriers::kFew; ++other)
    EXPECT_EQ(park(other, 2'000), WriteBarriers::kFew);
  EXPECT_EQ(park(99, 1), 0U) << "all places are taken";
}

// Another publisher's samples, however many, are not those that were waited for.
TEST(WriteBarriers, EachWaitsForItsOwnPublisher) {
  WriteBarriers write_barriers;
  for (const std::uint64_t publisher : {6, 7, 8})
    ASSERT_EQ(pass(write_barriers, behind_barrier(publisher, 5)), WriteBarriers::Outcome::parked);
  write_barriers.update({{6, 4}, {8, 100}, {9, 100}});
  const std::vector<AskPointer> ready = write_barriers.take_ready();
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_EQ(ready[0]->query->barrier_publisher, 8U);
  EXPECT_EQ(write_barriers.applied(6), 4U);
  EXPECT_EQ(write_barriers.applied(7), 0U);
  EXPECT_EQ(write_barriers.applied(8), 100U);
  write_barriers.update({{6, 5}});
  EXPECT_EQ(write_barriers.take_ready().size(), 1U);
  EXPECT_FALSE(write_barriers.empty()) << "7 has not come";
}

TEST(WriteBarriers, SoManyWaitAndNoMore) {
  WriteBarriers write_barriers;
  for (std::size_t i = 0; i < WriteBarriers::kMost; ++i) {
    AskPointer ask = behind_barrier(7, 5);
    ask->from.participant = i + 1;
    ASSERT_EQ(pass(write_barriers, std::move(ask)), WriteBarriers::Outcome::parked);
  }
  AskPointer one_more = behind_barrier(7, 5);
  EXPECT_EQ(write_barriers.pass(one_more), WriteBarriers::Outcome::full);
  EXPECT_TRUE(one_more) << "whoever is turned away is to be told";
  EXPECT_EQ(pass(write_barriers, behind_barrier(0, 0)), WriteBarriers::Outcome::passed)
      << "who need not wait needs no room";
  EXPECT_EQ(write_barriers.take_all().size(), WriteBarriers::kMost);
  EXPECT_EQ(write_barriers.pass(one_more), WriteBarriers::Outcome::parked);
}

}  // namespace
}  // namespace collided::engine::service
