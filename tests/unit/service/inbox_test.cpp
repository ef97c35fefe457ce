#include "server/service/ingest/inbox.hpp"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "server/service/ingest/listeners.hpp"

namespace collided::engine::service {
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

std::vector<Arrival> take_round(Inbox& inbox) {
  std::vector<Arrival> arrivals;
  inbox.take_round(std::chrono::steady_clock::now(), arrivals);
  return arrivals;
}

std::vector<Arrival> drain(Inbox& inbox) {
  std::vector<Arrival> all;
  for (std::vector<Arrival> round = take_round(inbox); !round.empty(); round = take_round(inbox))
    std::move(round.begin(), round.end(), std::back_inserter(all));
  return all;
}

std::unique_ptr<PoseSample> batch_of(std::uint64_t publisher, std::uint64_t sequence, std::uint8_t flags = 0) {
  auto sample = batch(sequence, {{1, 1}}, flags);
  sample->publisher = publisher;
  return sample;
}

/// Publisher and sequence of the batches among them; of anything else (0, 0).
std::vector<std::pair<std::uint64_t, std::uint64_t>> batches_of(const std::vector<Arrival>& arrivals) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> batches;
  for (const Arrival& arrival : arrivals) {
    const auto* sample = std::get_if<std::unique_ptr<PoseSample>>(&arrival);
    batches.emplace_back(sample ? (*sample)->publisher : 0, sample ? (*sample)->sequence : 0);
  }
  return batches;
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

// A hundred instants of one, sent at once, each of which needs a step of its own, do not keep the others waiting.
TEST(Inbox, EachPublisherHasItsTurnInEachRound) {
  using Batches = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
  Inbox inbox;
  for (std::uint64_t i = 1; i <= 3; ++i) inbox.push(batch_of(7, i));
  inbox.push(batch_of(8, 1, wire_contract::kPosesMoreFollows));
  inbox.push(batch_of(8, 2));
  inbox.push(batch_of(8, 3));
  EXPECT_EQ(batches_of(take_round(inbox)), (Batches{{7, 1}, {8, 1}, {8, 2}})) << "an instant is not torn";
  inbox.push(batch_of(9, 1));
  EXPECT_EQ(batches_of(take_round(inbox)), (Batches{{7, 2}, {8, 3}, {9, 1}})) << "who comes now need not wait";
  EXPECT_EQ(batches_of(take_round(inbox)), (Batches{{7, 3}}));
  EXPECT_TRUE(take_round(inbox).empty());
}

// A name that is free once its publisher is lost, a command that asks for what was just moved: nothing passes them.
TEST(Inbox, NothingPassesADefinitionNewsOrAJob) {
  using Batches = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
  Inbox inbox;
  for (std::uint64_t i = 1; i <= 2; ++i) inbox.push(batch_of(7, i));
  inbox.push(WriterNews{.publisher = 7});
  ASSERT_TRUE(inbox.push_job([] {}));
  inbox.push(batch_of(8, 1));
  EXPECT_EQ(batches_of(take_round(inbox)), (Batches{{7, 1}}));
  EXPECT_EQ(batches_of(take_round(inbox)), (Batches{{7, 2}, {0, 0}, {0, 0}}));
  EXPECT_EQ(batches_of(take_round(inbox)), (Batches{{8, 1}}));
}

// Who floods is merged, not who shares the server with it; up to as much again as the limits say.
TEST(Inbox, AFloodMergesItsOwnPosesOnly) {
  using Batches = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
  Inbox inbox({.batches = 2, .poses = 100, .own_batches = 2, .merged_objects = 9, .definition_bytes = 1, .jobs = 1});
  for (std::uint64_t i = 1; i <= 5; ++i) inbox.push(batch_of(7, i));
  inbox.push(batch_of(8, 1));
  inbox.push(batch_of(8, 2));
  inbox.push(batch_of(9, 1));  // the fifth: merged
  EXPECT_EQ(batches_of(take_round(inbox)), (Batches{{7, 1}, {8, 1}, {9, 1}}));
  EXPECT_EQ(batches_of(take_round(inbox)), (Batches{{7, 2}, {8, 2}, {7, 5}}));
  EXPECT_TRUE(take_round(inbox).empty());
  EXPECT_EQ(inbox.counts().poses_superseded, 2U);
  EXPECT_EQ(inbox.counts().poses_dropped, 0U);
}

TEST(Inbox, MergedPosesSayHowManyTheyReplacedAndOfWhichObjects) {
  Inbox inbox({.batches = 1, .poses = 100, .own_batches = 1, .merged_objects = 9, .definition_bytes = 1, .jobs = 1});
  inbox.push(batch(1, {{1, 1}}));
  for (std::uint64_t i = 2; i <= 5; ++i) inbox.push(batch(i, {{1, 1}}));
  inbox.push(batch(6, {{2, 1}}));
  const std::vector<Arrival> arrivals = drain(inbox);
  ASSERT_EQ(arrivals.size(), 2U);
  EXPECT_EQ(std::get<std::unique_ptr<PoseSample>>(arrivals[0])->merged, 0U);
  const PoseSample& merged = *std::get<std::unique_ptr<PoseSample>>(arrivals[1]);
  EXPECT_EQ(merged.object_numbers, (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(merged.merged, 3U) << "of four";
  EXPECT_EQ(merged.merged_objects, (std::vector<std::uint8_t>{1, 0}));
}

// Publishers come and go under ever new numbers: what is kept of each is given up, and nothing that waits with it.
TEST(Inbox, ManyPublishersLoseNothing) {
  Inbox inbox({.batches = 10'000, .merged_publishers = 10});
  for (std::uint64_t publisher = 1; publisher <= 1'000; ++publisher) {
    inbox.push(batch_of(publisher, 1));
    inbox.push(batch_of(publisher, 2));
    if (publisher % 7 == 0) { EXPECT_FALSE(take_round(inbox).empty()); }
  }
  std::size_t left = drain(inbox).size();
  EXPECT_GT(left, 0U);
  EXPECT_TRUE(drain(inbox).empty());
  EXPECT_EQ(inbox.counts().poses_superseded + inbox.counts().poses_dropped, 0U);
}

// A batch whose columns differ in length is merged away, and its memory carries the next publisher's poses.
TEST(Inbox, AMalformedBatchSpoilsNoLaterOne) {
  Inbox inbox({.batches = 0, .poses = 0, .merged_objects = 10, .definition_bytes = 1'000, .jobs = 1});
  std::unique_ptr<PoseSample> odd = batch(1, {{1, 1}});
  odd->has_odd_columns = true;
  odd->poses.clear();
  odd->object_numbers.clear();
  inbox.push(std::move(odd));
  inbox.push(batch(2, {{1, 2}}));
  bool carried = false;
  for (const Arrival& arrival : drain(inbox)) {
    const PoseSample& sample = *std::get<std::unique_ptr<PoseSample>>(arrival);
    EXPECT_FALSE(sample.has_odd_columns);
    carried = carried || sample.object_numbers == std::vector<std::uint32_t>{1};
  }
  EXPECT_TRUE(carried);
}

// Beyond the limit the newest pose of each object stays, the ones before it are counted, and nothing is forgotten.
TEST(Inbox, MergesWhatIsSupersededAndCountsIt) {
  Inbox inbox(
      {.batches = 2, .poses = 100, .own_batches = 1, .merged_objects = 3, .definition_bytes = 1'000, .jobs = 1});
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

// What is left of many batches has the stamps of the newest, for each publisher its own.
TEST(Inbox, WhatWasMergedHasTheStampsOfTheNewest) {
  Inbox inbox({.batches = 0, .poses = 0, .merged_objects = 10, .definition_bytes = 1'000, .jobs = 1});
  for (const std::uint64_t publisher : {7, 8}) {
    for (std::uint64_t sequence = 1; sequence <= 3; ++sequence) {
      auto sample = batch(publisher * 10 + sequence, {{1, static_cast<double>(sequence)}});
      sample->publisher = publisher;
      sample->incarnation = publisher * 2;
      sample->definitions_through = sequence == 2 ? 40 : 4;
      sample->source_time_ns = static_cast<std::int64_t>(publisher * 100 + sequence);
      sample->received_ns = static_cast<std::int64_t>(publisher * 1'000 + sequence);
      inbox.push(std::move(sample));
    }
  }
  const std::vector<Arrival> arrivals = drain(inbox);
  ASSERT_EQ(arrivals.size(), 2U);
  for (const Arrival& arrival : arrivals) {
    const PoseSample& merged = *std::get<std::unique_ptr<PoseSample>>(arrival);
    EXPECT_EQ(merged.incarnation, merged.publisher * 2);
    EXPECT_EQ(merged.sequence, merged.publisher * 10 + 3);
    EXPECT_EQ(merged.definitions_through, 40U) << "the poses of the second batch may be of those";
    EXPECT_EQ(merged.source_time_ns, static_cast<std::int64_t>(merged.publisher * 100 + 3));
    EXPECT_EQ(merged.received_ns, static_cast<std::int64_t>(merged.publisher * 1'000 + 3));
    EXPECT_EQ(merged.flags, 0);
    EXPECT_EQ(merged.poses, (std::vector<double>{0, 0, 3, 1, 0, 0, 0}));
  }
  EXPECT_EQ(inbox.counts().poses_superseded, 4U);
}

// A program that starts again while its earlier poses wait: they are of another life.
// Else the poses would be dated by their reception: later than they were.
TEST(Inbox, ASignOfLifeTakesNothingFromWhatItIsMergedWith) {
  Inbox inbox({.batches = 0, .poses = 0, .merged_objects = 10, .definition_bytes = 1'000, .jobs = 1});
  auto posed = batch(1, {{1, 1}}, wire_contract::kPosesStreamed);
  posed->source_time_ns = 500;
  posed->received_ns = 900;
  inbox.push(std::move(posed));
  auto sign_of_life = batch(2, {}, wire_contract::kPosesAllSaid);
  sign_of_life->received_ns = 950;
  inbox.push(std::move(sign_of_life));
  auto stamped = batch(0, {}, wire_contract::kPosesStreamed);
  stamped->source_time_ns = 700;
  stamped->received_ns = 960;
  inbox.push(std::move(stamped));
  std::vector<Arrival> arrivals = drain(inbox);
  ASSERT_EQ(arrivals.size(), 1U);
  const PoseSample& merged = *std::get<std::unique_ptr<PoseSample>>(arrivals[0]);
  EXPECT_EQ(merged.source_time_ns, 500);
  EXPECT_EQ(merged.received_ns, 900);
  EXPECT_EQ(merged.sequence, 2U);
  EXPECT_EQ(merged.flags, wire_contract::kPosesStreamed | wire_contract::kPosesAllSaid)
      << "what was said of the publisher holds";
  // And nothing is left over for the next that is merged; a framed publisher stays one beside its signs of life.
  inbox.push(batch(3, {{1, 2}}));
  inbox.push(batch(0, {}, wire_contract::kPosesStreamed));
  arrivals = drain(inbox);
  ASSERT_EQ(arrivals.size(), 1U);
  EXPECT_EQ(std::get<std::unique_ptr<PoseSample>>(arrivals[0])->flags, 0);
  EXPECT_EQ(std::get<std::unique_ptr<PoseSample>>(arrivals[0])->source_time_ns, 0);
}

TEST(Inbox, ALaterLifeTakesThePlaceOfAnEarlierOne) {
  Inbox inbox({.batches = 0, .poses = 0, .merged_objects = 3, .definition_bytes = 1'000, .jobs = 1});
  inbox.push(batch(50, {{1, 1}, {2, 1}}, wire_contract::kPosesTeleported));
  auto reborn = batch(3, {{2, 5}});
  reborn->incarnation = 2;
  inbox.push(std::move(reborn));
  inbox.push(batch(51, {{1, 9}}));  // late, of the earlier life
  auto more = batch(4, {{3, 6}, {4, 6}});
  more->incarnation = 2;
  inbox.push(std::move(more));
  const std::vector<Arrival> arrivals = drain(inbox);
  ASSERT_EQ(arrivals.size(), 1U);
  const PoseSample& merged = *std::get<std::unique_ptr<PoseSample>>(arrivals[0]);
  EXPECT_EQ(merged.incarnation, 2U);
  EXPECT_EQ(merged.sequence, 4U);
  EXPECT_EQ(merged.flags, 0) << "it was the earlier life that jumped";
  EXPECT_EQ(merged.object_numbers, (std::vector<std::uint32_t>{2, 3, 4}))
      << "the room of the earlier life's is free again";
  EXPECT_EQ(inbox.counts().poses_superseded, 3U);
  EXPECT_EQ(inbox.counts().poses_dropped, 0U);
}

// Once some are merged, a batch that would fit again must not overtake them; after a drain nothing of that is left.
TEST(Inbox, NothingOvertakesWhatWasMerged) {
  Inbox inbox({.batches = 9, .poses = 2, .own_batches = 0, .merged_objects = 9, .definition_bytes = 1'000, .jobs = 1});
  inbox.push(batch(1, {{1, 1}, {2, 1}}));
  inbox.push(batch(2, {{1, 2}}));
  EXPECT_EQ(drain(inbox).size(), 2U);
  inbox.push(batch(3, {{1, 3}, {2, 3}, {3, 3}}));
  inbox.push(batch(4, {{1, 4}}));
  const std::vector<Arrival> arrivals = drain(inbox);
  ASSERT_EQ(arrivals.size(), 1U) << "the second would have fit";
  EXPECT_EQ(std::get<std::unique_ptr<PoseSample>>(arrivals[0])->poses[2], 4);
  inbox.push(batch(5, {{2, 5}}));
  const std::vector<Arrival> next = drain(inbox);
  ASSERT_EQ(next.size(), 1U);
  EXPECT_EQ(std::get<std::unique_ptr<PoseSample>>(next[0])->object_numbers, std::vector<std::uint32_t>{2})
      << "1 and 3 were told already";
  EXPECT_EQ(inbox.counts().poses_superseded, 1U);
}

// A skipped teleport must not become a sweep across the room.
TEST(Inbox, AMergedTeleportStaysOne) {
  Inbox inbox({.batches = 0, .poses = 0, .merged_objects = 10, .definition_bytes = 1'000, .jobs = 1});
  inbox.push(batch(1, {{1, 1}, {2, 1}}, wire_contract::kPosesTeleported));
  inbox.push(batch(2, {{1, 2}, {3, 2}}));
  const std::vector<Arrival> arrivals = drain(inbox);
  ASSERT_EQ(arrivals.size(), 2U);
  for (const Arrival& arrival : arrivals) {
    const PoseSample& sample = *std::get<std::unique_ptr<PoseSample>>(arrival);
    const bool teleported = sample.flags == wire_contract::kPosesTeleported;
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
  inbox.push_own_job([] {});  // the server's own
  EXPECT_EQ(drain(inbox).size(), 3U);
  EXPECT_TRUE(inbox.push_job([] {}));
}

// The limits are of what waits: after each drain there is room for as much as at the beginning, of every kind.
TEST(Inbox, EveryRoundHasTheWholeRoom) {
  Inbox inbox({.batches = 2, .poses = 2, .merged_objects = 9, .definition_bytes = sizeof(DefinitionSample), .jobs = 2});
  for (int round = 0; round < 3; ++round) {
    EXPECT_TRUE(inbox.push_job([] {})) << round;
    EXPECT_TRUE(inbox.push_job([] {})) << round;
    EXPECT_FALSE(inbox.push_job([] {})) << round;
    const std::uint64_t first = 2 * static_cast<std::uint64_t>(round) + 1;
    inbox.push(batch(first, {{1, 1}}));
    inbox.push(batch(first + 1, {{1, 2}}));
    EXPECT_TRUE(inbox.has_room_for_definitions()) << round;
    inbox.push(std::make_unique<DefinitionSample>());
    EXPECT_FALSE(inbox.has_room_for_definitions()) << round;
    const std::vector<Arrival> arrivals = drain(inbox);
    ASSERT_EQ(arrivals.size(), 5U) << round;
    EXPECT_EQ(std::get<std::unique_ptr<PoseSample>>(arrivals[2])->sequence, first);
    EXPECT_EQ(std::get<std::unique_ptr<PoseSample>>(arrivals[3])->sequence, first + 1)
        << "merged before there was need";
  }
}

using News = std::vector<std::tuple<std::uint64_t, WriterKind, bool>>;

News news_of(Inbox& inbox) {
  News news;
  for (const Arrival& arrival : drain(inbox)) {
    const WriterNews& told = std::get<WriterNews>(arrival);
    news.emplace_back(told.publisher, told.kind, told.alive);
  }
  return news;
}

// A lease that ran out may be renewed under the same handle; a writer that was deleted is gone for good.
TEST(PublisherLiveliness, AWriterWhoseLeaseRanOutIsKnownWhenItComesBackAndADeletedOneIsNot) {
  Inbox inbox;
  PublisherOwners owners;
  PublisherLiveliness table(inbox, owners, WriterKind::object);
  ASSERT_TRUE(table.admits(70, 7, [] { return std::uint64_t{1}; }));
  table.liveliness({.alive = 1, .not_alive = 0, .last_writer = 70});
  EXPECT_EQ(news_of(inbox), (News{{7, WriterKind::object, true}}));
  table.liveliness({.alive = 0, .not_alive = 1, .last_writer = 70});
  EXPECT_EQ(news_of(inbox), (News{{7, WriterKind::object, false}}));
  table.liveliness({.alive = 1, .not_alive = 0, .last_writer = 70});
  EXPECT_EQ(news_of(inbox), (News{{7, WriterKind::object, true}})) << "back under its handle";
  table.liveliness({.alive = 0, .not_alive = 0, .last_writer = 70});
  EXPECT_EQ(news_of(inbox), (News{{7, WriterKind::object, false}}));
  table.liveliness({.alive = 1, .not_alive = 0, .last_writer = 70});
  EXPECT_EQ(news_of(inbox), News{}) << "deleted, so the handle is nobody's";
  table.liveliness({.alive = 2, .not_alive = 0, .last_writer = 71});
  EXPECT_EQ(news_of(inbox), News{}) << "not heard of yet";
  table.lost(9);
  EXPECT_EQ(news_of(inbox), (News{{9, WriterKind::object, false}}));
}

// One sample under another's number could freeze, move, retire or remove its objects.
TEST(PublisherLiveliness, ANumberIsItsFirstParticipantsForAsLongAsOneOfItsWritersLives) {
  Inbox inbox;
  PublisherOwners owners;
  PublisherLiveliness objects(inbox, owners, WriterKind::object);
  PublisherLiveliness poses(inbox, owners, WriterKind::pose);
  const auto mine = [] { return std::uint64_t{1}; };
  const auto other = [] { return std::uint64_t{2}; };
  EXPECT_TRUE(objects.admits(70, 7, mine));
  EXPECT_FALSE(poses.admits(90, 7, other)) << "nobody had posed under it yet, and it is taken all the same";
  EXPECT_TRUE(poses.admits(71, 7, mine));
  EXPECT_FALSE(objects.admits(91, 7, other));
  EXPECT_EQ(owners.refused(), 2U);
  EXPECT_EQ(owners.take_forged(), std::vector<std::uint64_t>{7});
  EXPECT_TRUE(owners.take_forged().empty());
  poses.liveliness({.alive = 1, .not_alive = 0, .last_writer = 90});
  poses.liveliness({.alive = 0, .not_alive = 0, .last_writer = 90});
  EXPECT_EQ(news_of(inbox), News{}) << "the forger's going is nobody's loss";
  poses.liveliness({.alive = 1, .not_alive = 0, .last_writer = 71});
  poses.liveliness({.alive = 0, .not_alive = 0, .last_writer = 71});
  EXPECT_FALSE(poses.admits(92, 7, other)) << "its other writer lives";
  objects.liveliness({.alive = 1, .not_alive = 0, .last_writer = 70});
  objects.liveliness({.alive = 0, .not_alive = 1, .last_writer = 70});
  EXPECT_TRUE(poses.admits(92, 7, other)) << "lost: its program, started again, may come before DDS forgets it";
  news_of(inbox);
  objects.liveliness({.alive = 1, .not_alive = 0, .last_writer = 70});
  EXPECT_EQ(news_of(inbox), News{}) << "too late";
  EXPECT_FALSE(objects.admits(70, 7, mine));
  EXPECT_FALSE(objects.admits(93, 8, [] { return std::uint64_t{0}; })) << "a writer that is gone holds nothing";
}

TEST(PublisherLiveliness, OneProcessHasSoManyNumbersAndTheyGoWithIt) {
  Inbox inbox;
  PublisherOwners owners;
  PublisherLiveliness objects(inbox, owners, WriterKind::object);
  const auto mine = [] { return std::uint64_t{1}; };
  std::size_t admitted = 0;
  for (std::uint64_t number = 1; number <= 1'500; ++number) admitted += objects.admits(70, number, mine) ? 1 : 0;
  EXPECT_EQ(admitted, PublisherOwners::kMostOfOne);
  EXPECT_TRUE(objects.admits(80, 2'000, [] { return std::uint64_t{2}; })) << "others have theirs";
  objects.keep_only(std::vector<std::uint64_t>{80});
  EXPECT_EQ(news_of(inbox).size(), 0U) << "it may have come while the writers were listed";
  objects.keep_only(std::vector<std::uint64_t>{80});
  EXPECT_EQ(news_of(inbox).size(), admitted);
  EXPECT_TRUE(objects.admits(81, 1, [] { return std::uint64_t{2}; })) << "free again";
}

// Four processes took all places, and the next publisher's objects were nowhere.
TEST(PublisherLiveliness, TheLastPlacesAreForProcessesAndKeysWithFewNumbers) {
  constexpr std::size_t kOpen = PublisherOwners::kMost - PublisherOwners::kReserved;
  for (const bool has_keys : {false, true}) {
    Inbox inbox;
    PublisherOwners owners;
    PublisherLiveliness objects(inbox, owners, WriterKind::object);
    std::uint64_t number = 0;
    std::size_t admitted = 0;
    for (std::uint64_t process = 1; process <= 8; ++process) {
      const auto crowd = [&] { return has_keys ? NumberOwner(process, "crowd") : NumberOwner(process); };
      for (int i = 0; i < 250; ++i) admitted += objects.admits(process, ++number, crowd) ? 1 : 0;
    }
    // Without keys each process has its few; with them all of these have one share.
    EXPECT_EQ(admitted, has_keys ? kOpen : kOpen + 4 * PublisherOwners::kFew);
    EXPECT_NE(owners.why_refused(number).find("1000"), std::string::npos) << owners.why_refused(number);
    EXPECT_EQ(owners.take_refused(), number);
    EXPECT_EQ(owners.take_refused(), std::nullopt) << "the log stays short";
    const auto late = [&] { return has_keys ? NumberOwner(99, "late") : NumberOwner(99); };
    EXPECT_TRUE(objects.admits(990, ++number, late));
    EXPECT_EQ(owners.why_refused(number), "");
  }
}

// Everybody reads the numbers in the status. What a lost publisher has left must not be another's for that.
TEST(PublisherLiveliness, WithKeysANumberStaysWithTheirName) {
  Inbox inbox;
  PublisherOwners owners;
  PublisherLiveliness objects(inbox, owners, WriterKind::object);
  const auto first = [] { return NumberOwner(1, "robot7"); };
  const auto other = [] { return NumberOwner(2, "mallory"); };
  const auto again = [] { return NumberOwner(3, "robot7"); };
  EXPECT_TRUE(objects.admits(70, 7, first));
  for (int i = 0; i < 2; ++i) objects.keep_only({});
  EXPECT_FALSE(objects.admits(80, 7, other)) << "its process is gone, its name is not";
  EXPECT_EQ(owners.take_forged(), std::vector<std::uint64_t>{7});
  EXPECT_TRUE(objects.admits(90, 7, again));
  // Who uses ever new numbers loses its own first ones, nobody else's.
  for (std::uint64_t number = 100; number <= 100 + PublisherOwners::kMostRemembered; ++number) {
    EXPECT_TRUE(objects.admits(80, number, other));
    for (int i = 0; i < 2; ++i) objects.keep_only(std::vector<std::uint64_t>{90});
  }
  EXPECT_TRUE(objects.admits(91, 100, again)) << "forgotten";
  EXPECT_FALSE(objects.admits(91, 101, again)) << "still mallory's";
  for (int i = 0; i < 2; ++i) objects.keep_only({});
  EXPECT_FALSE(objects.admits(80, 7, other));
}

}  // namespace
}  // namespace collided::engine::service
