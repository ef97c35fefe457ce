// What a replay in time publishes, sample by sample, beside what was recorded.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <limits>

#include "client/library/recordings/recorded_run.hpp"
#include "client/library/recordings/replay_times.hpp"
#include "collided/recording.hpp"
#include "idl/cdr.hpp"
#include "idl/mcap/writer.hpp"
#include "idl/recording/recorded_topics.hpp"
#include "tests/service/wire/fake_server.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided {
namespace {

using namespace std::chrono_literals;
using recording::Recorded;
using test::FakeServer;

constexpr std::uint64_t kSecond_ns = 1'000'000'000;
constexpr std::uint64_t kMillisecond_ns = 1'000'000;

/// A file of a recording that goes with the test.
class RecordingFile {
 public:
  RecordingFile()
      : path_((std::filesystem::temp_directory_path() / ("wire_replay_" + std::to_string(::getpid()) + ".mcap"))
                  .string()),
        output_(path_),
        writer_(output_, recording::library_name(), recording::channels_of("collided")) {}
  ~RecordingFile() { std::filesystem::remove(path_); }

  template <class T>
  void write(Recorded topic, std::uint64_t log_time, const T& sample) {
    std::vector<std::byte> bytes(wire::cdr_size(sample));
    wire::write_cdr(sample, bytes);
    writer_.write(static_cast<std::uint16_t>(topic), log_time, log_time, bytes);
  }
  const std::string& close(std::uint64_t opening_messages) {
    writer_.metadata("recording", {{"opening_messages", std::to_string(opening_messages)}});
    EXPECT_TRUE(writer_.close());
    return path_;
  }

 private:
  std::string path_;
  mcap::FileOutput output_;
  mcap::FileWriter writer_;
};

class ClientReplay : public testing::Test {
 protected:
  static constexpr std::uint64_t kPublisher = 77;
  static constexpr std::uint64_t kBegin_ns = 1'700'000'000 * kSecond_ns;

  static void name(wire::Definition& definition, std::uint32_t number, std::uint64_t sequence) {
    definition.publisher = kPublisher;
    definition.incarnation = 5;
    definition.object_number = number;
    definition.sequence_number = sequence;
  }
  void define(std::uint64_t log_time, std::uint32_t number, std::uint64_t sequence, const char* object) {
    dds::Sample<wire::Definition> definition;
    name(*definition, number, sequence);
    definition->moving = true;
    definition->orientation[0] = 1;
    ASSERT_TRUE(dds::set_text(definition->name, object));
    file_.write(Recorded::object, log_time, *definition);
  }
  void remove(std::uint64_t log_time, std::uint32_t number, std::uint64_t sequence) {
    dds::Sample<wire::Definition> definition;
    name(*definition, number, sequence);
    definition->removed = true;
    file_.write(Recorded::object, log_time, *definition);
  }
  /// The recorded server's word: its state of that version has the publisher's samples so far.
  void state(std::uint64_t log_time, std::uint64_t version, std::uint64_t applied_through) {
    const std::vector<std::uint64_t> publishers{kPublisher}, applied{applied_through};
    const std::vector<std::uint8_t> states{0};
    dds::Sample<wire::Status> status;
    status->epoch = 3;
    status->version = version;
    dds::borrow(status->publishers, publishers);
    dds::borrow(status->applied_sequences, applied);
    dds::borrow(status->publisher_states, states);
    file_.write(Recorded::step, log_time, *status);
  }
  /// A ray and its miss, on the state of that version.
  void question(std::uint64_t log_time, std::uint64_t request, std::uint64_t version) {
    const std::vector<double> ray{-1, 0, 0, 0, 0, 1, 5};
    dds::Sample<wire::Query> query;
    query->client = 9;
    query->request = request;
    query->chunk_count = 1;
    query->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::ray);
    query->max_hits = 1;
    test::put_questions(*query, ray);
    file_.write(Recorded::query, log_time, *query);
    const std::vector<std::uint8_t> miss{0}, no_reason{0}, level{1};
    const std::vector<std::uint32_t> none{0};
    dds::Sample<wire::Reply> reply;
    reply->client = 9;
    reply->request = request;
    reply->chunk_count = 1;
    reply->epoch = 3;
    reply->version = version;
    dds::borrow(reply->answers, miss);
    dds::borrow(reply->reasons, no_reason);
    dds::borrow(reply->levels, level);
    for (auto* column : {&reply->hit_counts, &reply->nodes, &reply->exact_tests}) dds::borrow(*column, none);
    file_.write(Recorded::reply, log_time + 1, *reply);
  }
  static ConnectOptions here() {
    return {.domain = test::own_domain(), .name_space = test::own_namespace(), .wait = 5s};
  }

  void pose(std::uint64_t log_time, std::uint64_t sequence, double from, std::uint8_t flags,
            std::int64_t source_time_ns, std::uint64_t publisher = kPublisher) {
    dds::Sample<wire::PoseBatch> batch;
    batch->publisher = publisher;
    batch->incarnation = 5;
    batch->sequence_number = sequence;
    batch->definitions_through = 2;
    batch->source_time_ns = source_time_ns;
    batch->flags = flags;
    const std::vector<std::uint32_t> numbers{8, 9};
    std::vector<double> poses, velocities;
    for (int i = 0; i < 14; ++i) poses.push_back(from + i);
    for (int i = 0; i < 12; ++i) velocities.push_back(from + 100 + i);
    dds::borrow(batch->object_numbers, numbers);
    test::put_poses(*batch, poses);
    test::put_rows<wire::PoseBatch>(*batch, wire::kVelocityColumns, velocities);
    file_.write(Recorded::pose, log_time, *batch);
  }
  /// The run at that rate: what the server received of it.
  FakeServer::Received replayed(double rate, std::chrono::nanoseconds& took) {
    // What was there before is not waited for.
    define(kBegin_ns - 7'200 * kSecond_ns, 8, 1, "eight");
    define(kBegin_ns - 3'600 * kSecond_ns, 9, 2, "nine");
    // Stamped by a clock that counts from the machine's start.
    pose(kBegin_ns, 3, 1'000, 0, 111);
    pose(kBegin_ns + 40 * kMillisecond_ns, 4, 2'000, wire_contract::kPosesTeleported, 40'000'111);
    pose(kBegin_ns + 100 * kMillisecond_ns, 5, 3'000, 0, 100'000'111);
    const std::string path = file_.close(2);
    FakeServer server(test::own_namespace());
    const ConnectOptions here{.domain = test::own_domain(), .name_space = test::own_namespace(), .wait = 5s};
    const auto start = std::chrono::steady_clock::now();
    const auto in_time = [&] { return std::chrono::steady_clock::now() - start < 20s; };
    const Result<ReplayReport> report = replay(here, {.path = path, .rate = rate, .go_on = in_time});
    took = std::chrono::steady_clock::now() - start;
    EXPECT_TRUE(report) << report.error().message;
    if (report) {
      EXPECT_EQ(report->samples, 5u);
      EXPECT_FALSE(report->stopped);
    }
    return server.received();
  }
  void expect_replayed(double rate) {
    std::chrono::nanoseconds took{};
    const FakeServer::Received received = replayed(rate, took);
    ASSERT_EQ(received.batches.size(), 3u);
    const double froms[] = {1'000, 2'000, 3'000};
    const std::int64_t after_ns[] = {0, 40'000'000, 100'000'000};
    for (std::size_t i = 0; i < 3; ++i) {
      const FakeServer::Batch& batch = received.batches[i];
      EXPECT_EQ(batch.object_numbers, (std::vector<std::uint32_t>{8, 9}));
      ASSERT_EQ(batch.poses.size(), 14u);
      ASSERT_EQ(batch.velocities.size(), 12u);
      for (std::size_t k = 0; k < 14; ++k)
        EXPECT_EQ(batch.poses[k], froms[i] + static_cast<double>(k)) << "places are what they were";
      for (std::size_t k = 0; k < 12; ++k)
        EXPECT_EQ(batch.velocities[k], rate * (froms[i] + 100 + static_cast<double>(k)));
      EXPECT_EQ(static_cast<double>(batch.source_time_ns - received.batches[0].source_time_ns),
                static_cast<double>(after_ns[i]) / rate);
      EXPECT_EQ(batch.flags, i == 1 ? wire_contract::kPosesTeleported : 0);
      EXPECT_EQ(batch.sequence, 3 + i);
      EXPECT_EQ(batch.definitions_through, 2u);
    }
    EXPECT_GE(took, std::chrono::nanoseconds(static_cast<std::int64_t>(1e8 / rate)));
  }

  RecordingFile file_;
};

TEST_F(ClientReplay, AtItsOwnRateVelocitiesAndTimesAreWhatTheyWere) { expect_replayed(1); }

// What takes half the time moves twice as fast.
TEST_F(ClientReplay, AtTwiceTheRateVelocitiesAreTwiceAndTimesHalf) { expect_replayed(2); }

TEST_F(ClientReplay, AtAQuarterOfTheRateVelocitiesAreAQuarterAndTimesFourfold) { expect_replayed(0.25); }

// The clock of the machine that replays: stamps of a recording from long ago would be those of the past.
TEST_F(ClientReplay, SamplesAreStampedAsTheyArePublished) {
  const auto now_ns = [] {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  const std::int64_t before_ns = now_ns();
  std::chrono::nanoseconds took{};
  const FakeServer::Received received = replayed(4, took);
  ASSERT_EQ(received.batches.size(), 3u);
  EXPECT_GE(received.batches.front().source_time_ns, before_ns);
  EXPECT_LE(received.batches.back().source_time_ns, now_ns());
}

// Two objects of one publisher in the opening; a state that has only the first of them knows less than the file does.
TEST_F(ClientReplay, WhatWasAskedBeforeAllOfTheOpeningWasThereIsNotCompared) {
  define(kBegin_ns - 2, 8, 1, "eight");
  define(kBegin_ns - 1, 9, 2, "nine");
  state(kBegin_ns, 10, 1);
  question(kBegin_ns + 1, 1, 10);
  state(kBegin_ns + 10, 11, 2);
  question(kBegin_ns + 11, 2, 11);
  const std::string path = file_.close(2);
  const client::RecordedRun run = client::read_run(path);
  EXPECT_EQ(run.opening_through, (std::map<std::uint64_t, std::uint64_t>{{kPublisher, 2}}));
  ASSERT_EQ(run.requests.size(), 2u);
  FakeServer server(test::own_namespace());
  const Result<ReplayReport> report = replay(here(), {.path = path, .ask = true});
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->samples, 2u);
  EXPECT_EQ(report->questions, 1u);
  EXPECT_EQ(report->not_compared, 1u);
  EXPECT_EQ(report->why_not_compared,
            std::vector<std::string>{"1 asked before all of the opening was in the recorded world"});
}

TEST_F(ClientReplay, WhoWantsNoMoreIsToldThatItStopped) {
  define(kBegin_ns - 1, 8, 1, "eight");
  pose(kBegin_ns + 10'000 * kSecond_ns, 2, 1'000, 0, 111);
  const std::string path = file_.close(1);
  FakeServer server(test::own_namespace());
  int asked = 0;
  const Result<ReplayReport> report = replay(here(), {.path = path, .rate = 1e6, .go_on = [&] { return ++asked < 1; }});
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_TRUE(report->stopped);
  EXPECT_EQ(asked, 1) << "a no is not asked about again";
  EXPECT_EQ(report->samples, 1u) << "the opening";
}

// What it published goes at the end; what was removed before then has gone already. Of an object that is defined and removed at
// once the writer keeps the removal alone.
TEST_F(ClientReplay, AtItsEndItRemovesWhatIsStillThereOnce) {
  define(kBegin_ns - 2, 8, 1, "eight");
  define(kBegin_ns - 1, 9, 2, "nine");
  remove(kBegin_ns, 8, 3);
  const std::string path = file_.close(2);
  FakeServer server(test::own_namespace());
  const Result<ReplayReport> report = replay(here(), {.path = path});
  ASSERT_TRUE(report) << report.error().message;
  FakeServer::Received received;
  ASSERT_TRUE(test::eventually([&] {
    received = server.received();
    return !received.sequences.empty() && received.sequences.back() >= 4;
  }));
  EXPECT_EQ(received.sequences.back(), 4u) << "the removal of nine, and none of eight before it";
  EXPECT_TRUE(received.names.empty());
}

// Becoming a publisher takes milliseconds: the last of many would come so late that a server dates it by itself.
TEST_F(ClientReplay, ManyPublishersThatBeginTogetherAreThereBefore) {
  constexpr std::uint64_t kPublishers = 40;
  state(kBegin_ns, 10, 0);
  for (std::uint64_t i = 0; i < kPublishers; ++i) {
    const std::uint64_t at_ns = kBegin_ns + kSecond_ns + i * kMillisecond_ns;
    pose(at_ns, 3, 1'000, 0, static_cast<std::int64_t>(at_ns), 100 + i);
  }
  const std::string path = file_.close(0);
  FakeServer server(test::own_namespace());
  const Result<ReplayReport> report = replay(here(), {.path = path});
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->samples, kPublishers);
  EXPECT_EQ(server.received().writers_at_first, kPublishers);
}

/// A recording of one publisher, ten batches a second for ten seconds, of which each is recorded at written_at(its time).
class ReplayedTimes : public testing::Test {
 protected:
  static constexpr std::int64_t kFirst_ns = 1'700'000'000'000'000'000;
  static constexpr std::int64_t kTransit_ns = 200'000;

  template <class WrittenAt>
  client::RecordedRun recorded(const WrittenAt& written_at, std::int64_t clock_ns = 0) {
    client::RecordedRun run;
    for (std::int64_t i = 0; i < 100; ++i) {
      const std::int64_t at_ns = kFirst_ns + i * 100'000'000;
      run.items.push_back({.topic = Recorded::pose,
                           .log_time = static_cast<std::uint64_t>(written_at(at_ns + kTransit_ns)),
                           .data = {}});
      run.origins.push_back({.publisher = 7, .incarnation = 1, .stamp_ns = at_ns + clock_ns});
    }
    return run;
  }
  static std::int64_t pause(std::int64_t at_ns) {
    const bool is_within = at_ns > kFirst_ns + 3'000'000'000 && at_ns < kFirst_ns + 4'200'000'000;
    return is_within ? kFirst_ns + 4'200'000'000 + (at_ns - kFirst_ns) / 1'000'000 : at_ns;
  }
};

TEST_F(ReplayedTimes, AreThoseOfTheStampsWhereARecorderPaused) {
  client::RecordedRun run = recorded(pause);
  // A definition from amid the pause stays before the batch that follows it.
  run.items.insert(run.items.begin() + 35, {.topic = Recorded::object, .log_time = run.items[35].log_time, .data = {}});
  run.origins.insert(run.origins.begin() + 35, {.publisher = 7, .incarnation = 1});
  const client::ReplayTimes times = client::replay_times(run);
  EXPECT_EQ(times.undated_publishers, 0U);
  for (std::size_t i = 0; i < run.items.size(); ++i) {
    EXPECT_EQ(times.order[i], i);
    if (run.origins[i].stamp_ns == 0) continue;
    EXPECT_EQ(times.of[i].source_ns, run.origins[i].stamp_ns);
    EXPECT_EQ(times.of[i].due_ns, run.origins[i].stamp_ns + kTransit_ns);
  }
}

TEST_F(ReplayedTimes, AreThoseOfAClockThatIsFarOffToo) {
  constexpr std::int64_t kClock_ns = -1'600'000'000'000'000'000;
  const client::RecordedRun run = recorded(pause, kClock_ns);
  const client::ReplayTimes times = client::replay_times(run);
  EXPECT_EQ(times.undated_publishers, 0U);
  for (std::size_t i = 0; i < run.items.size(); ++i)
    EXPECT_EQ(times.of[i].source_ns, run.origins[i].stamp_ns - kClock_ns + kTransit_ns);
}

TEST_F(ReplayedTimes, OfAClockThatWasSetAreToldToBeUncertain) {
  client::RecordedRun run = recorded([](std::int64_t at_ns) { return at_ns; });
  for (std::size_t i = 0; i < 60; ++i) run.origins[i].stamp_ns -= 5'000'000'000;
  const client::ReplayTimes times = client::replay_times(run);
  EXPECT_EQ(times.undated_publishers, 1U);
  for (std::size_t i = 0; i < run.items.size(); ++i)
    EXPECT_NEAR(static_cast<double>(times.of[i].source_ns - static_cast<std::int64_t>(run.items[i].log_time)), 0, 3e5);
}

// Whatever a file says, sums of times do not overflow.
TEST_F(ReplayedTimes, OfAForgedFileAreTimes) {
  client::RecordedRun run = recorded([](std::int64_t at_ns) { return at_ns; });
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  run.items[3].log_time = std::numeric_limits<std::uint64_t>::max();
  run.origins[4].stamp_ns = kMost;
  run.origins[5].stamp_ns = std::numeric_limits<std::int64_t>::min();
  run.origins[6].stamp_ns = 1;
  const client::ReplayTimes times = client::replay_times(run);
  for (const client::ReplayTime& time : times.of) {
    EXPECT_GE(time.due_ns, 0);
    EXPECT_LT(time.due_ns, kMost / 2);
  }
}

TEST(ClientReplayRate, MustBeAboveZeroAndNotBeyondSense) {
  for (const double rate : {0., -1., 1.5e6, std::numeric_limits<double>::quiet_NaN()}) {
    const Result<ReplayReport> report = replay({}, {.path = "none.mcap", .rate = rate});
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::bad_input);
    EXPECT_NE(report.error().message.find("allowed above 0 up to 1e6"), std::string::npos) << report.error().message;
  }
}

}  // namespace
}  // namespace collided
