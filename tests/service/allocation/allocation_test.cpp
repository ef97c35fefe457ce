#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <random>
#include <thread>

#include "server/intake/scene.hpp"
#include "server/service/ingest/listeners.hpp"
#include "server/service/ingest/publishers.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/runtime/place.hpp"
#include "server/world/solids/declared.hpp"
#include "tests/service/allocation/counting.hpp"
#include "tests/service/wire/network.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided::engine::service {
namespace {

using test::Counts;
using wire_contract::QuestionKind;

constexpr std::uint64_t kClient = 0x77;
constexpr std::uint64_t kPublisher = 7;
constexpr std::uint32_t kMovers = 1'000;
// To another thread and back: its memory from the pool, into the queue, out of it, whose question it is, back to the
// pool; and one for a wake-up in vain.
constexpr std::uint64_t kHandOverLocks = 6;
/// A reply is there before the thread that wrote it has put its memory back: one hand-over from before may be counted.
constexpr std::uint64_t most_locks(std::uint64_t worker_writes) { return kHandOverLocks * (worker_writes + 1); }
// Who the writer is, memory, into the inbox, out of it, memory back; and one for a wake-up in vain.
constexpr std::uint64_t kPoseLocks = 6;

/// The answering side of the server as it is, around a world that stands still: nothing ticks, so that all that is
/// counted was done for a question.
struct ServingSide {
  ServingSide() {
    Scene scene = embedded_scene();
    const auto indexed = World::index_scene(scene, {});
    EXPECT_GT(declare_solids(indexed.scene, *indexed.geometry, "*").count, 0U) << "or inside has nothing to test";
    EXPECT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(indexed)));
    for (std::uint32_t number = 1; number <= kMovers; ++number) define(number);
    EXPECT_TRUE(world.step(clock.now_ns(), 1, {}));
    publishers.stepped();
    test::count_new_listeners(true);
    const std::string name_space = test::own_namespace();
    listeners.emplace(participant, place.asked_as(), clock, inbox, answering, &flight, nullptr, place);
    test::count_new_listeners(false);
  }
  void define(std::uint32_t number) {
    DefinitionSample sample;
    sample.publisher = kPublisher;
    sample.object_number = number;
    sample.incarnation = 1;
    sample.sequence = number;
    sample.name = "ball " + std::to_string(number);
    sample.publisher_name = "test";
    sample.pose = {0.3 * (number % 30), 0.3 * (number / 30), 1.5, 1, 0, 0, 0};
    Shape ball;
    ball.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.1});
    sample.shape = ball;
    EXPECT_EQ(publishers.define(sample, clock.now_ns()), Applied::done);
  }

  ~ServingSide() { std::filesystem::remove(flight.stem() + "_test.mcap"); }

  World world{WorldOptions{}};
  WorldClock clock;
  Place place{test::own_namespace()};
  WriteBarriers write_barriers;
  SnapshotLeases leases{world};
  QuestionCounts counts;
  BackgroundAudit audit{0, {}};
  Inbox inbox;
  Publishers publishers{world, {}};
  dds::Participant participant{test::far_side()};
  dds::Topic<wire::Reply> reply_topic{participant, test::own_namespace()};
  std::atomic<bool> planted{false};
  // As every server has one: what it notes is counted with the rest.
  FlightRecorder flight{test::own_namespace(), 60'000'000'000,
                        (std::filesystem::temp_directory_path() / ("allocation_" + test::own_namespace())).string()};
  PartMeshes part_meshes;
  QuestionSamples samples;
  Answering answering{
      {world, clock, write_barriers, leases, counts, audit, part_meshes, samples, place},
      reply_topic,
      AnsweringOptions{
          .server = 1, .epoch = 1, .threads = 1, .recovering = [this] { return allocate(); }, .flight = &flight},
      [](CommandAsk) {}};
  std::optional<Listeners> listeners;

  // A test reads it, so that no compiler leaves the allocation out.
  char* volatile planted_here = nullptr;

 private:
  /// An allocation where answers are made, once it is asked for.
  bool allocate() {
    if (!planted.load()) return false;
    delete[] planted_here;
    planted_here = new char[1];
    return false;
  }
};

/// Asks and publishes over the network stack, from this process's other DDS domain.
class Allocation : public ::testing::Test {
 protected:
  void SetUp() override {
    test::never_count_this_thread();
    ASSERT_TRUE(test::eventually([this] {
      return query_writer_.matched_readers() > 0 && pose_writer_.matched_readers() > 0 &&
             ask(QuestionKind::hello, {}, 100);
    }));
  }
  /// Sends it and waits for the answers, which a batch that takes longer than a turn has in several replies.
  bool ask(QuestionKind kind, const std::vector<double>& numbers, int patience_ms = 5'000) {
    wire::Query& query = *query_;
    query.client = kClient;
    query.request = ++request_;
    query.chunk_count = 1;
    query.kind = static_cast<std::uint8_t>(kind);
    query.mask = 0xffffffff;
    query.max_hits = 1'000;
    test::put_questions(query, numbers);
    expected_.store(wire::question_count(query).value_or(0));
    return query_writer_.write(query) &&
           test::eventually([&] { return answered_.load() == request_; }, std::chrono::milliseconds(patience_ms));
  }
  static std::vector<double> questions(QuestionKind kind, std::size_t count, unsigned seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> x(0, 9), z(0, 3), turn(-1, 1);
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i) {
      for (const double at : {x(random), x(random), z(random)}) numbers.push_back(at);
      if (kind == QuestionKind::inside)
        numbers.end()[-3] /= 2, numbers.end()[-2] /= 2, numbers.back() = -0.1;  // the floor
      if (kind == QuestionKind::ray) numbers.insert(numbers.end(), {turn(random), turn(random), turn(random), 20});
      if (kind == QuestionKind::sphere) numbers.push_back(0.5);
      if (kind == QuestionKind::box) numbers.insert(numbers.end(), {0.4, 0.5, 0.6, 1, 0, 0, 0});
      if (kind == QuestionKind::near) numbers.push_back(1);
    }
    return numbers;
  }
  /// What the serving side did for a message of questions asked so many times, once every thread that answers such a
  /// message has answered as many: a busy machine makes the reading thread pass single questions on for a while, and
  /// its memory is then still that of no question at all.
  Counts count(QuestionKind kind, const std::vector<double>& numbers, int times) {
    const bool single = numbers.size() <= 10;
    std::vector<double> batch;
    while (batch.size() < 20 * numbers.size()) batch.insert(batch.end(), numbers.begin(), numbers.end());
    EXPECT_TRUE(ask(kind, single ? batch : numbers));
    test::start_counting();
    const auto warm = [&] {
      const Counts so_far = test::counts_so_far();
      return (single ? so_far.listener_writes : so_far.worker_writes) >= static_cast<std::uint64_t>(times);
    };
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (!warm() && std::chrono::steady_clock::now() < give_up) EXPECT_TRUE(ask(kind, numbers));
    EXPECT_TRUE(warm()) << "the thread that is to answer has not";
    test::start_counting();
    for (int i = 0; i < times; ++i) EXPECT_TRUE(ask(kind, numbers));
    return test::stop_counting();
  }
  /// The same of three rounds, the one with the fewest allocations: on a busy machine a worker's first answers may still
  /// be among those that were counted. What each question, or each hundredth, allocates is there every time.
  Counts count_settled(QuestionKind kind, const std::vector<double>& numbers, int times) {
    constexpr int kRounds = 3;
    Counts fewest = count(kind, numbers, times);
    for (int round = 1; round < kRounds && fewest.allocations > 0; ++round) {
      const Counts counts = count(kind, numbers, times);
      if (counts.allocations < fewest.allocations) fewest = counts;
    }
    return fewest;
  }
  static void say(std::string_view what, const Counts& counts) {
    std::printf("%-24.*s takes %llu, replies %llu by listener + %llu by workers, allocations %llu, locks %llu\n",
                static_cast<int>(what.size()), what.data(), static_cast<unsigned long long>(counts.takes),
                static_cast<unsigned long long>(counts.listener_writes),
                static_cast<unsigned long long>(counts.worker_writes),
                static_cast<unsigned long long>(counts.allocations), static_cast<unsigned long long>(counts.locks));
  }

  ServingSide serving_;
  std::atomic<std::uint64_t> answered_{0};
  std::atomic<std::size_t> expected_{0};  // answers of the newest request
  std::uint64_t request_ = 0;
  dds::Sample<wire::Query> query_;
  dds::Sample<wire::Reply> reply_;
  dds::Participant participant_{test::near_side()};
  dds::Topic<wire::Query> query_topic_{participant_, test::own_namespace()};
  dds::Topic<wire::Reply> reply_topic_{participant_, test::own_namespace()};
  dds::Topic<wire::PoseBatch> pose_topic_{participant_, test::own_namespace()};
  dds::Reader<wire::Reply> reply_reader_{reply_topic_,
                                         {.data =
                                              [this](dds::Taker<wire::Reply> taker) {
                                                while (taker.take(reply_)) {
                                                  if (!reply_.info().valid_data) continue;
                                                  const std::size_t through =
                                                      reply_->first_question + reply_->answers._length;
                                                  if (through >= expected_.load()) answered_.store(reply_->request);
                                                }
                                              },
                                          .partition = wire_contract::reply_partition(kClient)}};
  dds::Writer<wire::Query> query_writer_{query_topic_};
  dds::Writer<wire::PoseBatch> pose_writer_{pose_topic_};
};

TEST_F(Allocation, NoneForASingleQuestionOfAnyKind) {
  for (const QuestionKind kind :
       {QuestionKind::ray, QuestionKind::sphere, QuestionKind::box, QuestionKind::near, QuestionKind::inside}) {
    const Counts counts = count_settled(kind, questions(kind, 1, 1), 200);
    say(wire_contract::name_of(kind), counts);
    EXPECT_EQ(counts.allocations, 0U) << wire_contract::name_of(kind);
    EXPECT_EQ(counts.takes, 200U);
    EXPECT_EQ(counts.listener_writes + counts.worker_writes, 200U);
    EXPECT_LE(counts.locks, most_locks(counts.worker_writes)) << "none where the reading thread answers";
  }
  EXPECT_GE(serving_.flight.write("test", 60'000'000'000).messages, 5U * 200U * 2U) << "each was noted, and its answer";
}

// Nobody reads them above; here somebody does, and each sample, too, costs no more than a try to lock.
TEST_F(Allocation, NoneForQuestionsOfWhichSomeAreSampled) {
  std::atomic<bool> is_over{false};
  std::atomic<std::uint64_t> since{0};
  std::thread reader([&] {
    test::never_count_this_thread();
    for (; !is_over.load(); std::this_thread::sleep_for(std::chrono::milliseconds(20)))
      for (const SampledQuestion& sample : serving_.samples.read(since.load(), 0, steady_ns()))
        since.store(sample.sequence);
  });
  const Counts counts = count_settled(QuestionKind::ray, questions(QuestionKind::ray, 1, 1), 200);
  EXPECT_TRUE(test::eventually([&] {
    return ask(QuestionKind::ray, questions(QuestionKind::ray, 1, 1)) && since.load() > 1;
  })) << "none was sampled";
  is_over.store(true);
  reader.join();
  say("sampled rays", counts);
  EXPECT_EQ(counts.allocations, 0U);
}

TEST_F(Allocation, NoneForABatchOfAThousandRays) {
  const Counts counts = count_settled(QuestionKind::ray, questions(QuestionKind::ray, 1'000, 1), 20);
  say("1,000 rays", counts);
  EXPECT_EQ(counts.allocations, 0U);
  // All answers of each are there; one that takes longer than a worker's turn has them in several replies.
  EXPECT_GE(counts.worker_writes, 20U) << "a batch is answered by a worker";
  EXPECT_EQ(counts.listener_writes, 0U);
  EXPECT_LE(counts.locks, most_locks(counts.worker_writes));
}

// The count above would be zero as well if nothing was counted.
TEST_F(Allocation, APlantedOneIsCounted) {
  serving_.planted.store(true);
  EXPECT_EQ(count_settled(QuestionKind::ray, questions(QuestionKind::ray, 1, 1), 200).allocations, 200U);
  EXPECT_EQ(count_settled(QuestionKind::ray, questions(QuestionKind::ray, 1'000, 1), 20).allocations, 20U);
}

// As many requests in chunks as may be open, each from its first chunk on.
TEST_F(Allocation, NoneForRequestsThatKeepTheirState) {
  SnapshotLeases book(serving_.world);
  std::vector<AskPointer> asks(2 * SnapshotLeases::kMostRequests);
  for (std::size_t i = 0; i < asks.size(); ++i) {
    asks[i] = std::make_unique<Ask>();
    asks[i]->query->client = 5;
    asks[i]->query->request = i;
    asks[i]->query->chunk_count = 2;
  }
  test::start_counting();
  {
    const test::CountHere here;
    for (AskPointer& ask : asks) {
      if (book.take(ask, 0, 0) != SnapshotLeases::Taken::pinned) break;
    }
    asks.front()->hold.release();
  }
  EXPECT_EQ(test::stop_counting().allocations, 0U);
  EXPECT_EQ(book.size(), SnapshotLeases::kMostRequests);
}

TEST_F(Allocation, NoneForABatchOfAThousandPosesUntilItIsApplied) {
  std::vector<std::uint32_t> numbers;
  std::vector<double> poses(kMovers * wire_contract::kPoseNumbers);
  for (std::uint32_t number = 1; number <= kMovers; ++number) numbers.push_back(number);
  std::vector<Arrival> arrivals;
  std::uint64_t sequence = kMovers;
  const auto round = [&] {
    for (std::size_t i = 0; i < kMovers; ++i) {
      const double x = static_cast<double>(i % 30) + 0.001 * static_cast<double>(sequence);
      std::copy_n(std::array<double, 7>{x, 2, 3, 1, 0, 0, 0}.begin(), 7, &poses[7 * i]);
    }
    dds::Sample<wire::PoseBatch> batch;
    batch->publisher = kPublisher;
    batch->incarnation = 1;
    batch->sequence_number = ++sequence;
    batch->definitions_through = kMovers;
    dds::borrow(batch->object_numbers, numbers);
    test::put_poses(*batch, poses);
    EXPECT_TRUE(pose_writer_.write(*batch));
    // As the world's thread does.
    const std::uint64_t applied = serving_.publishers.counts().poses_applied;
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (serving_.publishers.counts().poses_applied == applied && std::chrono::steady_clock::now() < give_up) {
      const test::CountHere here;
      serving_.inbox.take_round(give_up, arrivals);
      for (Arrival& arrival : arrivals) {
        auto* sample = std::get_if<std::unique_ptr<PoseSample>>(&arrival);
        if (!sample) continue;
        EXPECT_EQ(serving_.publishers.move(**sample, serving_.clock.now_ns()), Applied::done);
        serving_.inbox.give_back(std::move(*sample));
      }
    }
    EXPECT_EQ(serving_.publishers.counts().poses_applied, applied + kMovers);
    EXPECT_TRUE(serving_.world.step(serving_.clock.now_ns(), 1, {}));
    serving_.publishers.stepped();
  };
  for (int warm = 0; warm < 3; ++warm) round();
  test::start_counting();
  for (int i = 0; i < 20; ++i) round();
  const Counts counts = test::stop_counting();
  say("1,000 poses", counts);
  EXPECT_EQ(counts.allocations, 0U);
  EXPECT_EQ(counts.takes, 20U);
  EXPECT_LE(counts.locks, kPoseLocks * counts.takes);
}

}  // namespace
}  // namespace collided::engine::service
