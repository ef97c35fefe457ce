#include "server/service/inbox.hpp"

#include <gtest/gtest.h>

#include <map>

namespace collided::service {
namespace {

std::unique_ptr<PoseSample> batch(std::uint64_t sequence, const std::vector<std::pair<std::uint32_t, double>>& heights,
                                  std::uint8_t flags = 0) {
  auto sample = std::make_unique<PoseSample>();
  sample->publisher = 7;
  sample->incarnation = 1;
  sample->sequence = sequence;
  sample->flags = flags;
  for (const auto& [number, z] : heights) {
    sample->object_numbers.push_back(number);
    sample->poses.insert(sample->poses.end(), {0, 0, z, 1, 0, 0, 0});
  }
  return sample;
}

std::vector<Arrival> drain(Inbox& inbox) {
  std::vector<Arrival> arrivals;
  inbox.drain(std::chrono::steady_clock::now(), arrivals);
  return arrivals;
}

TEST(Inbox, KeepsTheOrder) {
  Inbox inbox;
  inbox.push(batch(1, {{1, 1}}));
  inbox.push(WriterNews{.publisher = 7});
  inbox.push(batch(2, {{1, 2}}));
  const std::vector<Arrival> arrivals = drain(inbox);
  ASSERT_EQ(arrivals.size(), 3U);
  EXPECT_EQ(std::get<std::unique_ptr<PoseSample>>(arrivals[0])->sequence, 1U);
  EXPECT_TRUE(std::holds_alternative<WriterNews>(arrivals[1]));
  EXPECT_TRUE(drain(inbox).empty());
}

// Beyond the limit the newest pose of each object stays, the ones before it are counted, and nothing is forgotten.
TEST(Inbox, MergesWhatIsSupersededAndCountsIt) {
  Inbox inbox({.batches = 2, .poses = 100, .merged_objects = 3, .definition_bytes = 1'000, .jobs = 1});
  inbox.push(batch(1, {{1, 1}}));
  inbox.push(batch(2, {{1, 2}}));
  inbox.push(batch(3, {{1, 3}, {2, 3}}));
  inbox.push(batch(4, {{1, 4}}));
  inbox.push(batch(5, {{3, 5}, {4, 5}}));  // number 4 is one too many
  const std::vector<Arrival> arrivals = drain(inbox);
  ASSERT_EQ(arrivals.size(), 3U);
  const PoseSample& merged = *std::get<std::unique_ptr<PoseSample>>(arrivals[2]);
  std::map<std::uint32_t, double> heights;
  for (std::size_t i = 0; i < merged.object_numbers.size(); ++i)
    heights[merged.object_numbers[i]] = merged.poses[7 * i + 2];
  EXPECT_EQ(heights, (std::map<std::uint32_t, double>{{1, 4}, {2, 3}, {3, 5}}));
  EXPECT_EQ(merged.sequence, 5U);
  EXPECT_EQ(inbox.counts().poses_superseded, 1U);
  EXPECT_EQ(inbox.counts().poses_dropped, 1U);
}

// A skipped teleport must not become a sweep across the room.
TEST(Inbox, AMergedTeleportStaysOne) {
  Inbox inbox({.batches = 0, .poses = 0, .merged_objects = 10, .definition_bytes = 1'000, .jobs = 1});
  inbox.push(batch(1, {{1, 1}, {2, 1}}, wire_contract::kTeleported));
  inbox.push(batch(2, {{1, 2}, {3, 2}}));
  const std::vector<Arrival> arrivals = drain(inbox);
  ASSERT_EQ(arrivals.size(), 2U);
  for (const Arrival& arrival : arrivals) {
    const PoseSample& sample = *std::get<std::unique_ptr<PoseSample>>(arrival);
    const bool teleported = sample.flags == wire_contract::kTeleported;
    EXPECT_EQ(sample.object_numbers.size(), teleported ? 2U : 1U);
  }
}

TEST(Inbox, ManyDefinitionsAreLeftWhereTheyAre) {
  Inbox inbox({.batches = 1, .poses = 1, .merged_objects = 1, .definition_bytes = 1'000, .jobs = 1});
  EXPECT_TRUE(inbox.has_room_for_definitions());
  auto sample = std::make_unique<DefinitionSample>();
  sample->shape_bytes.resize(2'000);
  inbox.push(std::move(sample));
  EXPECT_FALSE(inbox.has_room_for_definitions());
  drain(inbox);
  EXPECT_TRUE(inbox.has_room_for_definitions());
}

TEST(Inbox, JobsAreBounded) {
  Inbox inbox({.batches = 1, .poses = 1, .merged_objects = 1, .definition_bytes = 1'000, .jobs = 2});
  EXPECT_TRUE(inbox.push_job([] {}));
  EXPECT_TRUE(inbox.push_job([] {}));
  EXPECT_FALSE(inbox.push_job([] {}));
  drain(inbox);
  EXPECT_TRUE(inbox.push_job([] {}));
}

}  // namespace
}  // namespace collided::service
