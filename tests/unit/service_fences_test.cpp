// Questions that wait for a publisher's sample: which pass, which wait, for how long, and how many.
#include "server/service/fences.hpp"

#include <gtest/gtest.h>

namespace collided::engine::service {
namespace {

AskPointer fenced(std::uint64_t publisher, std::uint64_t sequence, std::int64_t taken_ns = 0, std::int64_t deadline_ns = 0) {
  auto ask = std::make_unique<Ask>();
  ask->query->fence_publisher = publisher;
  ask->query->fence_sequence = sequence;
  ask->query->deadline_ns = deadline_ns;
  ask->taken_ns = taken_ns;
  return ask;
}

Fences::Outcome pass(Fences& fences, AskPointer ask) { return fences.pass(ask); }

std::size_t overdue(Fences& fences, std::int64_t now_ns) { return fences.take_overdue(now_ns).size(); }

constexpr std::int64_t kMillisecond = 1'000'000;

// Who allows 5 ms for the answer is told after 5 ms that the sample has not come, not after a second.
TEST(Fences, AQuestionWaitsNoLongerThanItsOwnDeadline) {
  Fences fences;
  ASSERT_EQ(pass(fences, fenced(7, 5, 100 * kMillisecond, 5 * kMillisecond)), Fences::Outcome::parked);
  EXPECT_EQ(overdue(fences, 105 * kMillisecond), 0U);
  EXPECT_EQ(overdue(fences, 105 * kMillisecond + 1), 1U);
  EXPECT_TRUE(fences.empty());
}

TEST(Fences, ALongDeadlineOrNoneBuysTheUsualPatienceOnly) {
  for (const std::int64_t deadline_ns : {std::int64_t{0}, 60'000 * kMillisecond}) {
    Fences fences;
    ASSERT_EQ(pass(fences, fenced(7, 5, 100 * kMillisecond, deadline_ns)), Fences::Outcome::parked);
    EXPECT_EQ(overdue(fences, 100 * kMillisecond + Fences::kPatienceNs), 0U);
    EXPECT_EQ(overdue(fences, 100 * kMillisecond + Fences::kPatienceNs + 1), 1U);
  }
}

TEST(Fences, OnlyWhatIsOverdueIsTakenAndTheRestGoesOnWaiting) {
  Fences fences;
  for (const std::int64_t deadline_ns : {9, 3, 6}) {
    ASSERT_EQ(pass(fences, fenced(7, 5, 0, deadline_ns * kMillisecond)), Fences::Outcome::parked);
  }
  const std::vector<AskPointer> late = fences.take_overdue(7 * kMillisecond);
  ASSERT_EQ(late.size(), 2U);
  EXPECT_EQ(late[0]->query->deadline_ns, 3 * kMillisecond);
  EXPECT_EQ(late[1]->query->deadline_ns, 6 * kMillisecond);
  fences.update({{7, 5}});
  EXPECT_EQ(fences.take_ready().size(), 1U);
}

TEST(Fences, WhoNamesNoPublisherPassesAndWhoHasPassedDoesAgain) {
  Fences fences;
  EXPECT_EQ(pass(fences, fenced(0, 5)), Fences::Outcome::passed);
  EXPECT_EQ(pass(fences, fenced(7, 0)), Fences::Outcome::parked) << "nothing is known of it yet";
  fences.update({{7, 1}});
  std::vector<AskPointer> ready = fences.take_ready();
  ASSERT_EQ(ready.size(), 1U);
  // The publisher is forgotten before a worker comes to the question: it has passed all the same.
  fences.update({});
  EXPECT_EQ(pass(fences, std::move(ready[0])), Fences::Outcome::passed);
}

// Another publisher's samples, however many, are not those that were waited for.
TEST(Fences, EachWaitsForItsOwnPublisher) {
  Fences fences;
  for (const std::uint64_t publisher : {6, 7, 8}) ASSERT_EQ(pass(fences, fenced(publisher, 5)), Fences::Outcome::parked);
  fences.update({{6, 4}, {8, 100}, {9, 100}});
  const std::vector<AskPointer> ready = fences.take_ready();
  ASSERT_EQ(ready.size(), 1U);
  EXPECT_EQ(ready[0]->query->fence_publisher, 8U);
  EXPECT_EQ(fences.applied(6), 4U);
  EXPECT_EQ(fences.applied(7), 0U);
  EXPECT_EQ(fences.applied(8), 100U);
  fences.update({{6, 5}});
  EXPECT_EQ(fences.take_ready().size(), 1U);
  EXPECT_FALSE(fences.empty()) << "7 has not come";
}

TEST(Fences, SoManyWaitAndNoMore) {
  Fences fences;
  for (std::size_t i = 0; i < Fences::kMost; ++i) ASSERT_EQ(pass(fences, fenced(7, 5)), Fences::Outcome::parked);
  AskPointer one_more = fenced(7, 5);
  EXPECT_EQ(fences.pass(one_more), Fences::Outcome::full);
  EXPECT_TRUE(one_more) << "whoever is turned away is to be told";
  EXPECT_EQ(pass(fences, fenced(0, 0)), Fences::Outcome::passed) << "who need not wait needs no room";
  EXPECT_EQ(fences.take_all().size(), Fences::kMost);
  EXPECT_EQ(fences.pass(one_more), Fences::Outcome::parked);
}

}  // namespace
}  // namespace collided::engine::service
