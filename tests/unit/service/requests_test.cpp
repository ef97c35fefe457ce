#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>
#include <random>
#include <unistd.h>

#include "server/service/durability/epoch.hpp"
#include "server/service/ingest/sequence_watermark.hpp"
#include "server/service/ingest/source_clock.hpp"
#include "server/service/questions/reply_columns.hpp"
#include "server/service/questions/ask.hpp"
#include "server/service/questions/snapshot_leases.hpp"
#include "server/service/questions/write_barriers.hpp"
#include "server/service/runtime/clock.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided::engine::service {
namespace {

TEST(SequenceWatermark, TwoTopicsOneSeries) {
  SequenceWatermark mark;
  mark.apply_definition(1, 0);
  mark.apply_definition(2, 0);
  mark.apply_pose(4, 0);  // 3 may still be under way on the object topic
  EXPECT_EQ(mark.through(), 2U);
  mark.apply_definition(3, 0);
  EXPECT_EQ(mark.through(), 4U);
}

// Each topic is in order, so a number that both have passed will never come.
TEST(SequenceWatermark, WhatBothTopicsHavePassedNeverComes) {
  SequenceWatermark mark;
  mark.apply_definition(1, 0);
  mark.apply_pose(10, 0);
  mark.apply_definition(9, 0);
  EXPECT_EQ(mark.through(), 10U);
}

TEST(SequenceWatermark, AGapIsGivenUpInTheEnd) {
  SequenceWatermark mark;
  mark.apply_pose(1, 0);
  mark.apply_pose(3, 0);
  mark.settle(SequenceWatermark::kGapPatienceNs - 1);
  EXPECT_EQ(mark.through(), 1U);
  mark.settle(SequenceWatermark::kGapPatienceNs);
  EXPECT_EQ(mark.through(), 3U);
  for (std::uint64_t sequence = 5; sequence < 500; ++sequence) mark.apply_pose(sequence, 0);
  EXPECT_EQ(mark.through(), 499U) << "a long run beyond a gap must not be kept";
}

// As many batches as a publisher has under way may overtake a definition.
TEST(SequenceWatermark, ALateDefinitionIsWaitedForWhateverIsUnderWay) {
  constexpr std::uint64_t kUnderWay = wire_contract::kPoseTopic.keep_last;
  SequenceWatermark mark;
  mark.apply_definition(1, 0);
  for (std::uint64_t sequence = 3; sequence < 3 + kUnderWay; ++sequence) mark.apply_pose(sequence, 0);
  EXPECT_EQ(mark.through(), 1U);
  mark.apply_definition(2, 0);
  EXPECT_EQ(mark.through(), 2 + kUnderWay);
}

// What is lost is given up so long after it was missed, however much comes behind it meanwhile.
TEST(SequenceWatermark, AGapIsAsOldAsItsBeginning) {
  SequenceWatermark mark;
  mark.apply_pose(1, 0);
  constexpr std::int64_t kTenth = SequenceWatermark::kGapPatienceNs / 10;
  for (std::uint64_t i = 0; i < 10; ++i) mark.apply_pose(3 + i, static_cast<std::int64_t>(i) * kTenth);
  mark.settle(10 * kTenth - 1);
  EXPECT_EQ(mark.through(), 1U);
  mark.settle(10 * kTenth);
  EXPECT_EQ(mark.through(), 12U);
  // The next gap is another one, with its own patience.
  mark.apply_pose(14, 12 * kTenth);
  mark.settle(21 * kTenth);
  EXPECT_EQ(mark.through(), 12U);
  mark.settle(22 * kTenth);
  EXPECT_EQ(mark.through(), 14U);
}

// World time is what publishers say; how long a batch was under way does not show.
TEST(SourceClock, AStampIsTakenAsItIs) {
  SourceClock clock;
  EXPECT_EQ(clock.stamp(1'000'000, 5'000'000).time_ns, 1'000'000);
  EXPECT_EQ(clock.stamp(2'000'000, 406'700'000).time_ns, 2'000'000) << "however late it comes";
  EXPECT_EQ(clock.stamp(2'000'000, 406'700'000).kind, StampKind::good) << "a second batch of one instant";
}

TEST(SourceClock, WhatGoesBackIsLateAndALongWayBackIsAJump) {
  SourceClock clock;
  const std::int64_t start = 1'000'000'000'000;
  EXPECT_EQ(clock.stamp(start, start).kind, StampKind::good);
  const WorldStamp late = clock.stamp(start - 1, start + 10);
  EXPECT_EQ(late.kind, StampKind::late);
  EXPECT_EQ(late.time_ns, start + 1) << "where things are now is news all the same";
  const WorldStamp jumped = clock.stamp(start - SourceClock::kMostOffNs - 1, start + 20);
  EXPECT_EQ(jumped.kind, StampKind::jumped);
  EXPECT_GT(jumped.time_ns, late.time_ns) << "what was said stays said";
  EXPECT_EQ(clock.stamp(start + 2'000'000'000, start + 30).kind, StampKind::jumped) << "ahead, faster than time";
}

TEST(SourceClock, WhatANetworkHeldBackIsNoJump) {
  SourceClock clock;
  constexpr std::int64_t kSecond = 1'000'000'000;
  const std::int64_t start = 1'700'000'000 * kSecond;
  clock.stamp(start, start);
  EXPECT_EQ(clock.stamp(start + kSecond / 10, start + 3 * kSecond).kind, StampKind::good) << "held back for 3 s";
  EXPECT_EQ(clock.stamp(start + 3 * kSecond, start + 3 * kSecond + 1).kind, StampKind::good)
      << "the next was not sent for as long";
  EXPECT_EQ(clock.stamp(start + 4 * kSecond, start + 3 * kSecond + 2).kind, StampKind::jumped)
      << "a second that is to come";
  SourceClock simulated;
  simulated.stamp(start, start);
  for (int i = 1; i <= 20; ++i) simulated.stamp(start + i * kSecond / 4, start + i * kSecond / 40);
  EXPECT_EQ(simulated.stamp(start + 6 * kSecond, start + 2 * kSecond).kind, StampKind::good)
      << "ahead already, and paused";
}

// Nanoseconds since boot count from where the first batch came, and go on as the publisher's clock does.
TEST(SourceClock, AClockOfAnotherEpochKeepsItsOwnSteps) {
  SourceClock clock;
  const std::int64_t now = 1'700'000'000'000'000'000;
  EXPECT_EQ(clock.stamp(77'000'000'000, now).time_ns, now);
  EXPECT_EQ(clock.stamp(77'010'000'000, now + 13'000'000).time_ns, now + 10'000'000);
}

TEST(SourceClock, WithoutStampsTheReceptionCounts) {
  SourceClock clock;
  EXPECT_EQ(clock.stamp(0, 8'000'000).time_ns, 8'000'000);
  EXPECT_EQ(clock.stamp(0, 7'000'000).time_ns, 8'000'000) << "time does not go back";
  EXPECT_EQ(clock.stamp(-5, 9'000'000).kind, StampKind::none);
}

TEST(SourceClock, ItIsAsFarBehindAsTheQuickestBatchOfLateSays) {
  SourceClock clock;
  constexpr std::int64_t kMs = 1'000'000;
  const std::int64_t start = 1'700'000'000'000'000'000;
  EXPECT_EQ(clock.behind_ns(), std::nullopt);
  clock.stamp(start, start + 9 * kMs);
  EXPECT_EQ(clock.behind_ns(), 9 * kMs);
  clock.stamp(start + 100 * kMs, start + 103 * kMs);
  clock.stamp(start + 200 * kMs, start + 240 * kMs);
  EXPECT_EQ(clock.behind_ns(), 3 * kMs) << "others were longer under way";
  clock.stamp(start + 1'100 * kMs, start + 1'107 * kMs);
  EXPECT_EQ(clock.behind_ns(), 3 * kMs) << "the second before counts";
  clock.stamp(start + 2'200 * kMs, start + 2'206 * kMs);
  EXPECT_EQ(clock.behind_ns(), 6 * kMs) << "and the one before that does not";
  clock.stamp(start + 9'000 * kMs, start + 8'700 * kMs);
  EXPECT_EQ(clock.behind_ns(), -300 * kMs) << "it is ahead";
  SourceClock since_boot;
  since_boot.stamp(77'000'000'000, start);
  EXPECT_EQ(since_boot.behind_ns(), std::nullopt) << "nobody knows";
}

class SnapshotLeasesTest : public ::testing::Test {
 protected:
  SnapshotLeasesTest() {
    book.on_ready([this](AskPointer ask) { ready.push_back(std::move(ask)); });
  }
  ~SnapshotLeasesTest() override {
    at_hand.clear();
    ready.clear();
  }
  void step() { ASSERT_TRUE(world.step(++time_ns, 1, {})); }
  static AskPointer chunk(std::uint64_t client, std::uint64_t request, std::uint32_t index, std::uint32_t count) {
    auto ask = std::make_unique<Ask>();
    ask->query->client = client;
    ask->query->request = request;
    ask->query->chunk_index = index;
    ask->query->chunk_count = count;
    return ask;
  }
  /// Takes a chunk, which stays at hand.
  SnapshotLeases::Taken take(std::uint64_t request, std::uint32_t index, std::uint32_t count, std::int64_t now_ns = 0,
                             std::uint64_t least_version = 0, std::uint64_t client = 1) {
    AskPointer ask = chunk(client, request, index, count);
    const SnapshotLeases::Taken taken = book.take(ask, least_version, now_ns);
    if (ask) at_hand.push_back(std::move(ask));
    return taken;
  }
  /// The state of a chunk that is answered at once; nothing where it has none.
  std::optional<std::uint64_t> version(std::uint64_t request, std::uint32_t index, std::uint32_t count,
                                       std::int64_t now_ns = 0, std::uint64_t least_version = 0,
                                       std::uint64_t client = 1) {
    if (take(request, index, count, now_ns, least_version, client) != Taken::pinned) return std::nullopt;
    const std::uint64_t found = at_hand.back()->hold.state()->version;
    at_hand.pop_back();
    return found;
  }
  using Taken = SnapshotLeases::Taken;
  World world{WorldOptions{}};
  SnapshotLeases book{world};
  std::vector<AskPointer> at_hand;
  std::vector<AskPointer> ready;  // came back through on_ready
  std::int64_t time_ns = 0;
};

TEST_F(SnapshotLeasesTest, AllChunksOfARequestSeeOneState) {
  const auto first = version(1, 0, 3);
  step();
  EXPECT_EQ(version(1, 1, 3), first);
  EXPECT_NE(version(2, 0, 2), first);
  EXPECT_EQ(version(1, 2, 3), first);
  EXPECT_EQ(book.size(), 1U) << "the last chunk lets the state go";
  EXPECT_FALSE(version(1, 1, 3)) << "a chunk after the last one has no state";
  EXPECT_FALSE(version(9, 1, 3)) << "nor has one whose first chunk never came";
}

// Requests are counted by each client for itself: the same number is another request.
TEST_F(SnapshotLeasesTest, RequestsOfTwoClientsWithOneNumberAreTwo) {
  const auto first = version(5, 0, 2, 0, 0, 1);
  step();
  const auto second = version(5, 0, 2, 0, 0, 2);
  EXPECT_EQ(*second, *first + 1);
  EXPECT_EQ(book.size(), 2U);
  step();
  EXPECT_EQ(version(5, 1, 2, 0, 0, 1), first);
  EXPECT_EQ(version(5, 1, 2, 0, 0, 2), second);
  EXPECT_EQ(book.size(), 0U);
}

// Each of a hundred requests needs a state of its own; eight have one, the others wait for them, in order.
TEST_F(SnapshotLeasesTest, ARequestWithoutAStateWaitsForOneThatEnds) {
  constexpr std::uint64_t kRequests = 100;
  constexpr std::int64_t kApart = 2 * SnapshotLeases::kSharedAgeNs;
  for (std::uint64_t request = 1; request <= kRequests; ++request) {
    const bool has_state = request <= SnapshotLeases::kMostStates;
    EXPECT_EQ(take(request, 0, 1, kApart * static_cast<std::int64_t>(request)),
              has_state ? Taken::pinned : Taken::waits)
        << request;
    step();
  }
  EXPECT_EQ(book.size(), kRequests);
  std::vector<std::uint64_t> ended;
  while (!at_hand.empty()) {
    ended.push_back(at_hand.front()->query->request);
    at_hand.erase(at_hand.begin());
    for (AskPointer& ask : ready) {
      ASSERT_TRUE(ask->hold);
      at_hand.push_back(std::move(ask));
    }
    ready.clear();
  }
  ASSERT_EQ(ended.size(), kRequests);
  EXPECT_TRUE(std::ranges::is_sorted(ended));
  EXPECT_EQ(book.size(), 0U);
}

// Later chunks of a request that waits come back with its first, on the same state.
TEST_F(SnapshotLeasesTest, AllChunksOfAWaitingRequestComeBack) {
  for (std::uint64_t request = 1; request <= SnapshotLeases::kMostStates; ++request) {
    EXPECT_EQ(take(request, 0, 1), Taken::pinned);
    step();
  }
  const std::int64_t later_ns = SnapshotLeases::kSharedAgeNs + 1;
  for (std::uint32_t index = 0; index < 3; ++index) EXPECT_EQ(take(50, index, 3, later_ns), Taken::waits);
  EXPECT_TRUE(ready.empty());
  at_hand.pop_back();
  ASSERT_EQ(ready.size(), 3U);
  for (const AskPointer& ask : ready) EXPECT_EQ(ask->hold.state()->version, world.newest()->version);
}

// A client that opens requests and never ends them must stop neither the world nor others for long.
TEST_F(SnapshotLeasesTest, OnlyAClientThatKeepsOthersWaitingLosesItsState) {
  for (std::uint64_t request = 1; request <= SnapshotLeases::kMostStates; ++request) {
    EXPECT_TRUE(version(request, 0, 2));
    step();
  }
  constexpr std::int64_t kPatient = SnapshotLeases::kLongestPauseNs / 2;
  const std::int64_t start_ns = steady_ns();
  book.expire(start_ns);
  book.expire(start_ns + kPatient);
  EXPECT_EQ(book.size(), SnapshotLeases::kMostStates) << "nobody waits";
  EXPECT_EQ(take(50, 0, 1, start_ns + kPatient), Taken::waits);
  book.expire(start_ns + kPatient + SnapshotLeases::kPatienceNs / 2);
  EXPECT_TRUE(ready.empty());
  EXPECT_TRUE(version(1, 1, 2)) << "its second chunk came in time";
  EXPECT_EQ(ready.size(), 1U) << "and made room";
  ready.clear();
  step();
  EXPECT_EQ(take(51, 0, 1, start_ns + kPatient), Taken::pinned);
  step();
  EXPECT_EQ(take(52, 0, 1, start_ns + kPatient + SnapshotLeases::kSharedAgeNs + 1), Taken::waits);
  book.expire(start_ns + kPatient + 2 * SnapshotLeases::kPatienceNs);
  EXPECT_EQ(ready.size(), 1U);
  EXPECT_EQ(take(3, 1, 2, start_ns + kPatient), Taken::gone) << "it kept request 52 waiting";
}

// However slowly the server answers, the state stays: time counts against a client only while nothing of it is here.
TEST_F(SnapshotLeasesTest, AChunkAtHandKeepsTheStateForEver) {
  EXPECT_EQ(take(1, 0, 2), Taken::pinned);
  for (std::uint64_t request = 2; request <= SnapshotLeases::kMostStates; ++request) {
    step();
    EXPECT_EQ(take(request, 0, 1), Taken::pinned);
  }
  step();
  EXPECT_EQ(take(50, 0, 1, SnapshotLeases::kSharedAgeNs + 1), Taken::waits);
  book.expire(steady_ns() + 1'000 * SnapshotLeases::kLongestPauseNs);
  EXPECT_EQ(take(1, 1, 2), Taken::pinned);
}

TEST_F(SnapshotLeasesTest, ManyAtOnceShareYoungStates) {
  for (std::uint64_t request = 1; request <= 50; ++request) {
    EXPECT_TRUE(version(request, 0, 2, static_cast<std::int64_t>(request)));
    step();
  }
  EXPECT_EQ(book.size(), 50U);
  for (std::uint64_t request = 1; request <= 50; ++request) EXPECT_TRUE(version(request, 1, 2)) << request;
}

// A client that saw a state is never answered on an older one, however many requests are under way.
TEST_F(SnapshotLeasesTest, SharingAStateNeverGoesBack) {
  for (std::uint64_t request = 1; request <= 100; ++request) {
    step();
    version(request, 0, 2, static_cast<std::int64_t>(request));
  }
  const std::uint64_t newest = world.newest()->version;
  step();
  EXPECT_EQ(version(101, 0, 2, 101, 0), version(100, 1, 2, 101)) << "a client that knows of nothing newer shares";
  EXPECT_EQ(take(102, 0, 1, 102, newest + 1), Taken::waits) << "one that does waits for what is as new";
}

// Chunks are as large as clients make them; what waits is bounded in bytes.
TEST_F(SnapshotLeasesTest, WhatWaitsIsBoundedInBytes) {
  for (std::uint64_t request = 1; request <= SnapshotLeases::kMostStates; ++request) {
    EXPECT_EQ(take(request, 0, 1), Taken::pinned);
    step();
  }
  std::vector<std::uint8_t> large(std::size_t{1} << 20);
  const auto take_large = [&](std::uint64_t request, std::uint32_t index) {
    AskPointer ask = chunk(1, request, index, 4);
    dds::borrow(ask->query->blob, large);
    const Taken taken = book.take(ask, 0, 2 * SnapshotLeases::kSharedAgeNs);
    if (ask) dds::borrow(ask->query->blob, std::span<const std::uint8_t>());
    return taken;
  };
  std::uint64_t request = 100;
  while (take_large(request, 0) == Taken::waits) ++request;
  EXPECT_EQ(request - 100, 15U) << "a quarter of the room, for the first chunks of requests";
  std::size_t chunks = request - 100;
  for (std::uint64_t one = 100; one < request; ++one) {
    for (std::uint32_t index = 1; index < 4; ++index) chunks += take_large(one, index) == Taken::waits ? 1 : 0;
  }
  EXPECT_EQ(chunks, 60U) << "and all of the others of what was begun";
  const std::vector<AskPointer> waiting = book.take_waiting();
  EXPECT_EQ(waiting.size(), chunks);
  for (const AskPointer& ask : waiting) dds::borrow(ask->query->blob, std::span<const std::uint8_t>());
  EXPECT_EQ(take_large(request, 0), Taken::waits) << "there is room again";
  for (const AskPointer& ask : book.take_waiting()) dds::borrow(ask->query->blob, std::span<const std::uint8_t>());
}

TEST_F(SnapshotLeasesTest, BeyondTheLimitARequestIsToBeAskedAgain) {
  for (std::uint64_t request = 1; request <= SnapshotLeases::kMostRequests; ++request)
    ASSERT_EQ(take(request, 0, 1), Taken::pinned);
  EXPECT_EQ(take(SnapshotLeases::kMostRequests + 1, 0, 1), Taken::full);
  at_hand.erase(at_hand.begin());
  EXPECT_EQ(take(SnapshotLeases::kMostRequests + 1, 0, 1), Taken::pinned);
}

AskPointer behind_barrier(std::uint64_t request, std::uint64_t sequence) {
  auto ask = std::make_unique<Ask>();
  ask->query->request = request;
  ask->query->barrier_publisher = 7;
  ask->query->barrier_sequence = sequence;
  return ask;
}

TEST(WriteBarriers, LetPassInOrderOnceTheSampleIsIn) {
  WriteBarriers write_barriers;
  AskPointer first = behind_barrier(1, 5);
  AskPointer second = behind_barrier(2, 4);
  AskPointer third = behind_barrier(3, 9);
  EXPECT_EQ(write_barriers.pass(first), WriteBarriers::Outcome::parked);
  EXPECT_EQ(write_barriers.pass(second), WriteBarriers::Outcome::parked);
  EXPECT_EQ(write_barriers.pass(third), WriteBarriers::Outcome::parked);
  write_barriers.update({{3, 100}, {7, 5}});
  const std::vector<AskPointer> ready = write_barriers.take_ready();
  ASSERT_EQ(ready.size(), 2U);
  EXPECT_EQ(ready[0]->query->request, 1U);
  EXPECT_EQ(ready[1]->query->request, 2U);
  AskPointer fourth = behind_barrier(4, 5);
  EXPECT_EQ(write_barriers.pass(fourth), WriteBarriers::Outcome::passed);
  EXPECT_EQ(write_barriers.take_overdue(WriteBarriers::kPatienceNs + 1).size(), 1U);
  EXPECT_TRUE(write_barriers.empty());
}

// Both ends of what is allowed are answered, what lies beyond is refused by name.
TEST(AskLimits, AreThoseThatTheRefusalNames) {
  const std::vector<double> ray{0, 0, 0, 0, 0, 1, 1};
  const auto refusal = [&](const std::function<void(wire::Query&)>& change) {
    Ask ask;
    wire::Query& query = *ask.query;
    query.kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::ray);
    query.chunk_count = 1;
    query.max_hits = 1;
    test::put_questions(query, ray);
    change(query);
    return why_refused(query).value_or("");
  };
  using wire_contract::kMaxHitsPerChunk;
  using wire_contract::kMaxQuestionsPerRequest;
  EXPECT_EQ(refusal([](wire::Query&) {}), "");
  EXPECT_EQ(refusal([](wire::Query& q) { q.chunk_count = 4, q.chunk_index = 3; }), "");
  EXPECT_NE(refusal([](wire::Query& q) { q.chunk_count = 4, q.chunk_index = 4; }).find("they count from 0"),
            std::string::npos);
  EXPECT_NE(refusal([](wire::Query& q) { q.chunk_count = 0; }), "");
  EXPECT_EQ(refusal([](wire::Query& q) { q.chunk_count = kMaxQuestionsPerRequest; }), "");
  EXPECT_NE(refusal([](wire::Query& q) { q.chunk_count = kMaxQuestionsPerRequest + 1; }), "");
  EXPECT_EQ(refusal([](wire::Query& q) { q.first_question = kMaxQuestionsPerRequest - 1; }), "");
  EXPECT_NE(refusal([](wire::Query& q) { q.first_question = kMaxQuestionsPerRequest; }), "");
  EXPECT_EQ(refusal([](wire::Query& q) { q.max_hits = kMaxHitsPerChunk; }), "");
  EXPECT_NE(refusal([](wire::Query& q) { q.max_hits = kMaxHitsPerChunk + 1; }), "");
  EXPECT_NE(refusal([](wire::Query& q) { q.max_hits = 0; }), "");
  EXPECT_NE(refusal([](wire::Query& q) { q.deadline_ns = -1; }), "");
  EXPECT_NE(refusal([](wire::Query& q) { q.error_asked = -1e-300; }), "");
  EXPECT_NE(refusal([](wire::Query& q) { q.error_asked = std::numeric_limits<double>::quiet_NaN(); }), "");
  EXPECT_NE(refusal([](wire::Query& q) { q.kind = 9; }), "");
  EXPECT_NE(refusal([](wire::Query& q) { q.mode = 3; }), "");
}

/// Answers of `questions` spheres that all meet the same `objects`.
class ReplyFilling : public ::testing::Test {
 protected:
  void fill(std::uint32_t objects, std::uint32_t questions, std::size_t name_bytes) {
    for (std::uint32_t i = 0; i < objects; ++i) {
      Shape ball;
      ball.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 1});
      std::string name = std::to_string(i);
      name.resize(std::max(name.size(), name_bytes), '_');
      ObjectDefinition definition;
      definition.name = name;
      definition.shape = ball;
      definition.moving = false;
      ASSERT_TRUE(std::holds_alternative<ObjectId>(world.define(definition)));
    }
    world.step(1, 1, {});
    std::vector<double> numbers;
    for (std::uint32_t i = 0; i < questions; ++i) numbers.insert(numbers.end(), {0, 0, 0, 1});
    QueryScratch scratch;
    Questions asked;
    asked.kind = QuestionKind::sphere;
    asked.max_hits = 0xffffffff;
    asked.numbers = numbers;
    const auto state = world.newest();
    answer(*state, asked, answers, scratch);
    ReplyFiller filler(*state, answers, named_in, reply_number);
    ReplyColumns columns;
    while (filler.fill(columns)) {
      EXPECT_EQ(filler.first(), answered);
      EXPECT_LE(columns.objects.size(), wire_contract::kMaxHitsPerChunk);
      const std::size_t bytes = columns.objects.size() * (8 * wire_contract::kHitNumbers) +
                                columns.objects.size() * 13 + columns.names.size() + columns.named_ids.size() * 8 +
                                columns.answers.size() * 15;
      EXPECT_LT(bytes, wire_contract::kMaxMessageBytes);
      EXPECT_EQ(static_cast<std::size_t>(std::count(columns.names.begin(), columns.names.end(), 0)),
                columns.named_ids.size());
      answered += columns.answers.size();
      hits += columns.objects.size();
      ++replies;
      for (const std::uint8_t reason : columns.reasons)
        truncated += reason == static_cast<std::uint8_t>(UndecidedReason::truncated);
    }
  }
  World world{WorldOptions{}};
  Answers answers;
  std::vector<std::uint64_t> named_in;
  std::uint64_t reply_number = 0;
  std::size_t answered = 0, hits = 0, replies = 0, truncated = 0;
};

TEST_F(ReplyFilling, OneReplyWhereItFits) {
  fill(3, 100, 1);
  EXPECT_EQ(answered, 100U);
  EXPECT_EQ(hits, 300U);
  EXPECT_EQ(replies, 1U);
}

// A name is told once in a reply, so what is met again costs its hit alone: with long names a reply is nearly full here,
// and a byte more for each of 8,000 hits would cut it.
TEST_F(ReplyFilling, AQuestionThatMeetsTheSameObjectsAgainHasRoom) {
  constexpr std::uint32_t kObjects = 320;
  fill(kObjects, 1, wire_contract::kMaxNameBytes);
  ASSERT_EQ(answers.hits.size(), kObjects);
  while (answers.hits.size() < wire_contract::kMaxHitsPerChunk)
    answers.hits.push_back(answers.hits[answers.hits.size() % kObjects]);
  answers.hit_counts[0] = static_cast<std::uint32_t>(answers.hits.size());
  const auto state = world.newest();
  ReplyFiller filler(*state, answers, named_in, reply_number);
  ReplyColumns columns;
  ASSERT_TRUE(filler.fill(columns));
  EXPECT_EQ(columns.objects.size(), wire_contract::kMaxHitsPerChunk);
  EXPECT_EQ(columns.named_ids.size(), kObjects);
  EXPECT_EQ(columns.reasons, std::vector<std::uint8_t>{static_cast<std::uint8_t>(answers.reasons[0])});
  EXPECT_EQ(filler.undecided(), 0U);
  EXPECT_FALSE(filler.fill(columns));
}

TEST_F(ReplyFilling, SplitsBetweenQuestions) {
  fill(1'000, 20, 1);
  EXPECT_EQ(answered, 20U);
  EXPECT_EQ(hits, 20'000U);
  EXPECT_EQ(replies, 3U);
  EXPECT_EQ(truncated, 0U);
}

// What no reply has room for is left out, and the answer says so.
TEST_F(ReplyFilling, TruncatesAloudWhereOneQuestionIsTooMuch) {
  fill(6'000, 2, 250);
  EXPECT_EQ(answered, 2U);
  EXPECT_EQ(truncated, 2U);
  EXPECT_LT(hits, 12'000U);
  EXPECT_GT(hits, 4'000U);
}

class EpochFile : public ::testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove_all(folder); }
  Epoch next(const std::string& dir) {
    return next_epoch(dir, 3, "a/b", [](const char*) -> const char* { return nullptr; });
  }
  const std::string folder =
      (std::filesystem::temp_directory_path() / ("collided_epoch_" + std::to_string(getpid()))).string();
};

TEST_F(EpochFile, GrowsWithEachStart) {
  Epoch first = next(folder);
  EXPECT_EQ(first.kept_in, folder + "/3-a-b.epoch");
  open_epoch(first);
  EXPECT_EQ(next(folder).rival_pid, getpid()) << "the first one still runs";
  first.lock.reset();
  EXPECT_GT(next(folder).value, first.value);
}

TEST_F(EpochFile, OneWithoutACopyMayBeFromBeforeThereWereAny) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/3-a-b.epoch") << "99999999999\n";
  EXPECT_EQ(next(folder).value, 100'000'000'000U);
  std::ofstream(folder + "/3-a-b.epoch") << "99999999999 running\n";
  EXPECT_EQ(next(folder).past, PastEnd::running);
  EXPECT_EQ(next(folder).value, 100'000'000'000U);
}

// As a server that stands by, behind one that has taken the primary's place.
TEST_F(EpochFile, OneThatIsRaisedWhileAServerRunsIsNotUsedAgain) {
  Epoch first = next(folder);
  open_epoch(first);
  const std::uint64_t raised = first.value + 1'000'000;
  EXPECT_EQ(raise_epoch(first, raised), "");
  EXPECT_EQ(first.value, raised);
  first.lock.reset();
  Epoch second = next(folder);
  EXPECT_EQ(second.value, raised + 1);
  EXPECT_EQ(second.past, PastEnd::running);
  std::filesystem::remove_all(folder);
  EXPECT_NE(raise_epoch(second, raised + 9), "") << "it cannot be written down";
  EXPECT_EQ(second.value, raised + 1);
}

// One damage to either file: the other one says how it was.
TEST_F(EpochFile, NoSingleDamageIsBelieved) {
  std::mt19937_64 random = oracle::seeded(103);
  std::filesystem::create_directories(folder);
  Epoch first = next(folder);
  first.value = 99'999'999'998;
  open_epoch(first);
  first.lock.reset();
  const std::string paths[] = {first.kept_in, first.kept_in + ".copy"};
  std::ifstream in(paths[0]);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  const char* asked_rounds = std::getenv("COLLIDED_DAMAGE_ROUNDS");
  const int rounds = asked_rounds != nullptr ? std::atoi(asked_rounds) : 400;
  for (int round = 0; round < rounds; ++round) {
    std::string text = whole;
    const std::size_t at = random() % text.size();
    if (round % 4 == 0) text[at] = static_cast<char>(text[at] ^ (1 << random() % 8));
    if (round % 4 == 1) text.resize(at);
    if (round % 4 == 2) std::generate(text.begin(), text.end(), [&] { return static_cast<char>(random()); });
    const std::string& path = paths[random() % 2];
    if (round % 4 == 3) std::filesystem::remove(path);
    else std::ofstream(path, std::ios::trunc) << text;
    const Epoch read = next(folder);
    ASSERT_EQ(read.past, PastEnd::running) << "round " << round << ": " << text;
    ASSERT_EQ(read.value, 99'999'999'999U) << "round " << round << ": " << text;
    ASSERT_EQ(read.damage.empty(), round % 4 == 3) << read.damage;
    std::ofstream(path, std::ios::trunc) << whole;
  }
}

// The lock's file was that of a process with a longer number.
TEST_F(EpochFile, TheLocksFileNamesItsHolderAndNobodyElse) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder + "/3-a-b.epoch.lock") << "123456789012\n";
  const Epoch epoch = next(folder);
  std::ifstream in(folder + "/3-a-b.epoch.lock");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), std::to_string(getpid()) + "\n");
}

TEST_F(EpochFile, WhoDidNotEndInOrderHasCrashed) {
  {
    Epoch first = next(folder);
    EXPECT_EQ(first.past, PastEnd::unknown) << "there was none before";
    open_epoch(first);
    EXPECT_EQ(first.problem, "");
  }
  EXPECT_EQ(next(folder).past, PastEnd::running);
  Epoch second = next(folder);
  open_epoch(second);
  close_epoch(second);
  const std::uint64_t last = second.value;
  second.lock.reset();
  const Epoch third = next(folder);
  EXPECT_EQ(third.past, PastEnd::stopped);
  EXPECT_EQ(third.value, last + 1);
}

TEST_F(EpochFile, FallsBackToTheClockAndSaysSo) {
  const Epoch epoch = next("/proc/nowhere");
  EXPECT_TRUE(epoch.kept_in.empty());
  EXPECT_FALSE(epoch.problem.empty());
  EXPECT_GT(epoch.value, 1'700'000'000U);
}

}  // namespace
}  // namespace collided::engine::service
