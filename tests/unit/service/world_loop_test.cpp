#include "server/service/world_loop.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <unistd.h>

#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/commands/commands.hpp"
#include "server/service/durability/durable_state.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/service/eventually.hpp"

namespace collided::engine::service {
namespace {

using wire_contract::ServerState;

/// Keeps the books that a subscriber would keep.
class BookKeeper : public EventWriter {
 public:
  bool contacts_wanted() const override { return true; }
  bool persisted_wanted() const override { return true; }
  bool probes_wanted() const override { return true; }
  bool watermarks_wanted() const override { return wants_watermarks; }
  void write_watermark(std::uint64_t next_sequence, const Stamp& stamp) override {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(next_sequence, last_sequence + 1);
    EXPECT_GE(stamp.settled_ns, watermark_ns) << "nobody publishes, so time does not go back";
    watermark_ns = stamp.settled_ns;
    ++watermarks;
    came.notify_all();
  }
  void write_events(const EventColumns& events, const Stamp& stamp) override {
    const std::lock_guard lock(mutex);
    settled_of_frames.push_back(stamp.settled_ns);
    EXPECT_LE(events.size(), wire_contract::kMaxEventsPerFrame);
    EXPECT_EQ(events.first_sequence, last_sequence + 1);
    std::set<ObjectId> named(events.named_ids.begin(), events.named_ids.end());
    for (std::size_t i = 0; i < events.size(); ++i) {
      EXPECT_TRUE(named.contains(events.a[i]) && named.contains(events.b[i]));
      const std::uint64_t hash = wire_contract::contact_hash(events.a[i], events.b[i], events.episodes[i]);
      const bool began = events.kinds[i] == static_cast<std::uint8_t>(EventKind::began);
      contact_hash += began ? hash : 0 - hash;
      (began ? began_count : ended_count) += 1;
      reasons[events.reasons[i]] += 1;
      ++last_sequence;
    }
    for (std::size_t start = 0; start < events.names.size();) {
      const std::string name(reinterpret_cast<const char*>(&events.names[start]));
      EXPECT_FALSE(name.empty()) << "an object that is gone has its name in the event that says so";
      start += name.size() + 1;
    }
    ++frames;
    came.notify_all();
  }
  void write_persisted(const EventColumns& events, const Stamp&) override {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(events.first_sequence, 0U);
    persisted += events.size();
    came.notify_all();
  }
  void write_contacts(const ContactColumns& contacts, const Stamp&, std::uint64_t as_of_sequence) override {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(as_of_sequence, last_sequence) << "shards come after the events that changed them";
    shards[contacts.shard] = contacts.size();
  }
  void write_probes(const ProbeColumns& probes, const Stamp& stamp) override {
    const std::lock_guard lock(mutex);
    EXPECT_LE(probes.size(), wire_contract::kMaxProbesPerFrame);
    probe_readings += probes.size();
    probe_version = stamp.version;
    came.notify_all();
  }
  void write_status(const StatusColumns& columns) override {
    const std::lock_guard lock(mutex);
    status = columns;
    std::size_t held = 0;
    for (const auto& [shard, count] : shards) held += count;
    EXPECT_EQ(columns.contact_count, held);
    EXPECT_EQ(columns.contact_hash, contact_hash);
    EXPECT_EQ(columns.last_event_sequence, last_sequence);
    ++statuses;
    came.notify_all();
  }

  void note(const std::string& sentence) {
    const std::lock_guard lock(mutex);
    notices += sentence + '\n';
    came.notify_all();
  }
  template <class Condition>
  bool wait(Condition&& condition) {
    std::unique_lock lock(mutex);
    return came.wait_for(lock, std::chrono::seconds(30), condition);
  }

  std::mutex mutex;
  std::condition_variable came;
  std::uint64_t last_sequence = 0;
  std::uint64_t contact_hash = 0;
  std::size_t began_count = 0, ended_count = 0, persisted = 0, frames = 0, statuses = 0, probe_readings = 0;
  std::uint64_t probe_version = 0;
  bool wants_watermarks = false;
  std::int64_t watermark_ns = 0;
  std::size_t watermarks = 0;
  std::vector<std::int64_t> settled_of_frames;
  std::map<std::uint8_t, std::size_t> reasons, shards;
  StatusColumns status;
  std::string notices;
};

class WorldLoopTest : public ::testing::Test {
 protected:
  explicit WorldLoopTest(const WorldOptions& options = {}) : world(options) {}
  ~WorldLoopTest() override { stop(); }
  void start(const LoopOptions& options = {}) {
    make_loop(options);
    run();
  }
  void expect_to_wait_for_adding(const LoopOptions& options) {
    std::atomic<bool> adding{true};
    loop = std::make_unique<WorldLoop>(
        WorldLoop::Collaborators{world,
                                 clock,
                                 inbox,
                                 books,
                                 write_barriers,
                                 leases,
                                 questions,
                                 place,
                                 [](AskPointer) {},
                                 [] {},
                                 [this](const std::string& sentence) { books.note(sentence); },
                                 {},
                                 [&] { return adding.load(); }},
        options);
    thread = std::thread([this] { loop->run(); });
    EXPECT_TRUE(books.wait([&] { return books.statuses > 4; }));
    EXPECT_TRUE(loop->recovering());
    EXPECT_EQ(books.status.state, ServerState::recovering);
    EXPECT_EQ(books.notices, "");
    adding = false;
    EXPECT_TRUE(books.wait([&] { return books.status.state == ServerState::ready; }));
    stop();
  }
  void make_loop(const LoopOptions& options = {}) {
    loop = std::make_unique<WorldLoop>(
        WorldLoop::Collaborators{world, clock, inbox, books, write_barriers, leases, questions, place,
                                 [this](AskPointer) { ++admitted; }, [] {},
                                 [this](const std::string& sentence) { books.note(sentence); }},
        options);
  }
  void run() {
    thread = std::thread([this] { loop->run(); });
  }
  void stop() {
    if (!thread.joinable()) return;
    loop->stop();
    thread.join();
  }
  /// The publisher's next batch, without poses.
  std::unique_ptr<PoseSample> batch() {
    auto sample = inbox.spare();
    sample->publisher = 7;
    sample->incarnation = 1;
    sample->sequence = ++sequence;
    sample->definitions_through = 0;
    sample->received_ns = clock.now_ns();
    sample->velocities.clear();
    return sample;
  }
  /// Balls that overlap, and batches that move all of them, in the inbox before the loop starts.
  void push_rounds(std::uint32_t balls, std::uint64_t rounds) {
    for (std::uint32_t number = 0; number < balls; ++number) define(number, {0, 0, 0});
    for (std::uint64_t round = 0; round < rounds; ++round) {
      auto sample = batch();
      for (std::uint32_t number = 0; number < balls; ++number) {
        sample->object_numbers.push_back(number);
        sample->poses.insert(sample->poses.end(), {1e-3 * number, 1e-3 * static_cast<double>(round), 0, 1, 0, 0, 0});
      }
      inbox.push(std::move(sample));
    }
  }
  void define(std::uint32_t number, const Vec3& position, bool removed = false,
              const Shape& shape = {{Sphere{.center = Vec3::Zero(), .radius_m = 0.5}}, nullptr}) {
    const std::vector<std::byte> bytes = encode_shape(shape);
    auto sample = std::make_unique<DefinitionSample>();
    sample->publisher = 7;
    sample->incarnation = 1;
    sample->object_number = number;
    sample->sequence = ++sequence;
    sample->name = "ball" + std::to_string(number);
    sample->removed = removed;
    sample->pose = {position.x(), position.y(), position.z(), 1, 0, 0, 0};
    for (const std::byte byte : bytes) sample->shape_bytes.push_back(static_cast<std::uint8_t>(byte));
    inbox.push(std::move(sample));
  }
  void move(std::uint32_t number, const Vec3& position) {
    auto sample = batch();
    sample->object_numbers = {number};
    sample->poses = {position.x(), position.y(), position.z(), 1, 0, 0, 0};
    inbox.push(std::move(sample));
  }
  World world;
  WorldClock clock;
  Inbox inbox;
  BookKeeper books;
  WriteBarriers write_barriers;
  SnapshotLeases leases{world};
  QuestionCounts questions;
  Place place;
  std::atomic<int> admitted{0};
  std::unique_ptr<WorldLoop> loop;
  std::thread thread;
  std::uint64_t sequence = 0;
};

// 60 balls in one place: 1,770 contacts at once do not fit one frame.
TEST_F(WorldLoopTest, ManyEventsComeInSeveralFrames) {
  for (std::uint32_t number = 0; number < 60; ++number) define(number, {0, 0, 0});
  start();
  EXPECT_TRUE(books.wait([&] { return books.began_count == 60 * 59 / 2; }));
  const std::size_t statuses = books.statuses;
  EXPECT_TRUE(books.wait([&] { return books.statuses > statuses + 1; }));
  EXPECT_GE(books.frames, 2U);
  EXPECT_EQ(books.settled_of_frames.front(), 0) << "more events of the same step follow";
  EXPECT_GT(books.settled_of_frames.back(), 0);
  EXPECT_EQ(books.shards.size(), wire_contract::kContactShards);
  EXPECT_EQ(books.status.contact_count, 1'770U);
  EXPECT_EQ(books.status.state, ServerState::ready);
}

// A world at rest decides up to its clock.
TEST_F(WorldLoopTest, WatermarksComeThoughNothingHappens) {
  books.wants_watermarks = true;
  start();
  EXPECT_TRUE(books.wait([&] { return books.watermarks > 10; }));
  const std::lock_guard lock(books.mutex);
  EXPECT_GT(books.watermark_ns, 0);
  EXPECT_TRUE(books.settled_of_frames.empty());
}

TEST_F(WorldLoopTest, WithoutAReaderOfWatermarksNoneAreWritten) {
  start();
  EXPECT_TRUE(books.wait([&] { return books.statuses > 4; }));
  EXPECT_EQ(books.watermarks, 0U);
}

// Nobody has fixed a ray to anything: not a byte of it. Then each step tells every probe's reading, in frames of at most
// 1,024.
TEST_F(WorldLoopTest, ProbesAreToldAfterEveryStepWhereThereAreAny) {
  define(1, {0, 0, 5});
  define(2, {0, 0, 0});
  start();
  EXPECT_TRUE(books.wait([&] { return books.statuses > 1; }));
  EXPECT_EQ(books.probe_readings, 0U);
  constexpr std::uint32_t kCount = wire_contract::kMaxProbesPerFrame + 10;
  const bool taken = inbox.push_job([&] {
    for (std::uint32_t i = 0; i < kCount; ++i) {
      EXPECT_FALSE(loop->probes().set({.name = "probe" + std::to_string(i), .object = "ball1"}));
    }
    EXPECT_NEAR(loop->read_probes().at(0).clearance_m, 4.5, 1e-12);
  });
  ASSERT_TRUE(taken);
  move(1, {0, 0, 4});
  EXPECT_TRUE(books.wait([&] { return books.probe_readings == kCount; }));
  const std::uint64_t version = books.probe_version;
  move(1, {0, 0, 3});
  EXPECT_TRUE(books.wait([&] { return books.probe_readings == 2 * kCount; }));
  EXPECT_GT(books.probe_version, version);
}

// After a crash commands of clients may fill the queue before the server has carried out again what was kept.
TEST_F(WorldLoopTest, WhatACrashLeftIsRestoredHoweverManyCommandsWait) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("restored_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  const auto life = [&](PastEnd past) {
    return std::make_unique<DurableState>(disk_in(folder.string()), "it.journal", past, [](const std::string&) {});
  };
  life(PastEnd::unknown)
      ->keep({.erased = {},
              .put = {{.key = {KeptKind::rule, "00"}, .text = R"({"command": "allow", "a": "crate", "b": "post"})"}}});
  const std::unique_ptr<DurableState> durable = life(PastEnd::running);
  Inventory inventory({[&](const Inventory::Changes& changes) { durable->keep(changes); }});
  durable->restore(inventory);
  ASSERT_EQ(durable->commands_left().size(), 1U);
  std::size_t waiting = 0;
  while (inbox.push_job([] {})) ++waiting;
  ASSERT_GE(waiting, 1U);
  make_loop();
  BackgroundAudit audit(0, {});
  PartMeshes part_meshes;
  QuestionSamples samples;
  Commands commands({.loop = *loop,
                     .inbox = inbox,
                     .clock = clock,
                     .counts = questions,
                     .audit = audit,
                     .durable = durable.get(),
                     .inventory = inventory,
                     .flight = nullptr,
                     .part_meshes = part_meshes,
                     .samples = samples,
                     .place = place},
                    "");
  commands.replay(durable->commands_left());
  // Time enough to find the queue full, while the world's thread does not run yet.
  EXPECT_FALSE(test::eventually([&] { return commands.replayed(); }, std::chrono::milliseconds(200)));
  run();
  EXPECT_TRUE(test::eventually([&] { return commands.replayed(); }, std::chrono::seconds(30)));
  stop();
  commands.stop();
  EXPECT_EQ(world.pair_rules().size(), 1U);
  EXPECT_TRUE(durable->losses().empty());
  durable->finish();
  std::filesystem::remove_all(folder);
}

class FullWorldLoopTest : public WorldLoopTest {
 protected:
  FullWorldLoopTest() : WorldLoopTest(WorldOptions{.max_contacts = 10}) {}
};

TEST_F(FullWorldLoopTest, TheStatusSaysThatContactsAreMissing) {
  for (std::uint32_t number = 0; number < 3; ++number) define(number, {0, 0, 0});
  start();
  EXPECT_TRUE(books.wait([&] { return books.status.contact_count == 3; }));
  EXPECT_FALSE(books.status.contacts_truncated);
  for (std::uint32_t number = 3; number < 60; ++number) define(number, {0, 0, 0});
  EXPECT_TRUE(books.wait([&] { return books.status.contacts_truncated; }));
}

TEST_F(WorldLoopTest, StoppingEndsWhatHolds) {
  define(1, {0, 0, 0});
  define(2, {0.5, 0, 0});
  start();
  EXPECT_TRUE(books.wait([&] { return books.began_count == 1; }));
  stop();
  EXPECT_EQ(books.ended_count, 1U);
  EXPECT_EQ(books.reasons[static_cast<std::uint8_t>(EndReason::server_stopping)], 1U);
  EXPECT_EQ(books.status.state, ServerState::stopping);
  EXPECT_EQ(books.status.contact_count, 0U);
}

// What a ball meets on its way is told, and so is what goes on.
TEST_F(WorldLoopTest, ContactsPersistAndEnd) {
  define(1, {0, 0, 0});
  define(2, {0.5, 0, 0});
  start();
  EXPECT_TRUE(books.wait([&] { return books.began_count == 1; }));
  move(2, {0.6, 0, 0});
  EXPECT_TRUE(books.wait([&] { return books.persisted > 0; }));
  define(1, {0, 0, 0}, true);
  EXPECT_TRUE(books.wait([&] { return books.ended_count == 1; }));
}

TEST_F(WorldLoopTest, ABarrierOpensWhenTheSampleIsInAState) {
  define(1, {0, 0, 0});
  start();
  auto ask = std::make_unique<Ask>();
  ask->query->barrier_publisher = 7;
  ask->query->barrier_sequence = 2;
  EXPECT_TRUE(write_barriers.pass(ask) == WriteBarriers::Outcome::parked);
  move(1, {1, 0, 0});
  EXPECT_TRUE(books.wait([&] { return admitted.load() == 1; }));
  const SnapshotRing::Lease state = world.newest();
  const auto& objects = state->objects;
  const auto ball =
      std::find_if(objects.begin(), objects.end(), [](const auto& info) { return info && info->name == "ball1"; });
  ASSERT_NE(ball, objects.end());
  EXPECT_EQ(state->poses[slot_of((*ball)->id)].position.x(), 1);
}

// With a fixed step nothing is lost either: an object that moved twice takes a step between.
TEST_F(WorldLoopTest, AFixedStepLooksAtEveryPose) {
  define(1, {0, 0, 0});
  define(2, {5, 0, 0});
  start({.step_ns = 50'000'000, .recovery_ns = 0, .limits = {}});
  for (int i = 0; i < 10; ++i) {
    move(2, {0.5, 0, 0});
    move(2, {5, 0, 0});
  }
  EXPECT_TRUE(books.wait([&] { return books.began_count == 10 && books.ended_count == 10; }));
}

TEST_F(WorldLoopTest, ItsPeriodIsThatOfItsOptions) {
  start({.step_ns = 50'000'000, .recovery_ns = 0, .limits = {}});
  EXPECT_EQ(loop->step_period_ns(), 50'000'000);
}

// Without a period a step waits as long as the last one took: the smallest of worlds need not wait 5 ms for the next. Two objects,
// since a second pose of the same one brings a step of its own.
TEST_F(WorldLoopTest, WithoutAPeriodQuickStepsFollowQuickly) {
  define(1, {0, 0, 0});
  define(2, {0, 50, 0});
  start({.step_ns = 0, .recovery_ns = 0, .limits = {}});
  EXPECT_TRUE(books.wait([&] { return books.statuses > 0; }));
  const auto moved = [&](std::uint32_t number, double x) {
    const std::uint64_t before = world.newest()->version;
    move(number, {x, 50. * (number - 1), 0});
    while (world.newest()->version == before) std::this_thread::yield();
    return std::chrono::steady_clock::now();
  };
  std::chrono::nanoseconds quickest = std::chrono::hours(1);
  for (int i = 0; i < 50; ++i) {
    const auto first = moved(1, i);
    quickest = std::min<std::chrono::nanoseconds>(quickest, moved(2, i) - first);
  }
  EXPECT_LT(quickest, std::chrono::milliseconds(4));
}

// Time alone moves nothing: a world in which everybody is heard takes no step, and its states get no new numbers.
TEST_F(WorldLoopTest, AWorldInWhichNothingChangesStandsStill) {
  define(1, {0, 0, 0});
  start();
  EXPECT_TRUE(books.wait([&] { return books.status.moving_count == 1 && books.statuses > 2; }));
  const std::uint64_t version = world.newest()->version;
  const std::uint64_t steps = loop->sums().steps.get();
  const std::size_t statuses = books.statuses;
  EXPECT_TRUE(books.wait([&] { return books.statuses > statuses + 8; }));  // ticks come with every second one
  EXPECT_EQ(world.newest()->version, version);
  EXPECT_EQ(loop->sums().steps.get(), steps);
}

// Taking samples in and stepping are counted apart, though a second pose of an object steps while samples are taken in: of one
// thread's time no moment is counted twice.
TEST_F(WorldLoopTest, NoTimeIsCountedTwice) {
  constexpr std::uint32_t kBalls = 100;
  constexpr std::uint64_t kRounds = 30;
  push_rounds(kBalls, kRounds);
  const auto before = std::chrono::steady_clock::now();
  start({.step_ns = 0, .recovery_ns = 0, .limits = {}});
  EXPECT_TRUE(books.wait([&] { return books.status.applied_sequences == std::vector<std::uint64_t>{sequence}; }));
  const std::size_t statuses = books.statuses;
  EXPECT_TRUE(books.wait([&] { return books.statuses > statuses; })) << "what was taken in is counted after it";
  const StepSums& sums = loop->sums();
  const std::uint64_t taken_ns = sums.take_ns.get();
  const std::uint64_t stepped_ns =
      sums.update_ns.get() + sums.index_ns.get() + sums.test_ns.get() + sums.publish_ns.get();
  const std::chrono::nanoseconds elapsed = std::chrono::steady_clock::now() - before;
  EXPECT_GE(sums.steps.get(), kRounds) << "each of the poses is looked at";
  EXPECT_GT(taken_ns, 0U);
  EXPECT_LE(taken_ns + stepped_ns, static_cast<std::uint64_t>(elapsed.count()));
}

// Of each step its stages, each with a clock of its own, and the whole, measured apart: nearly all of it is in a stage (A56).
TEST_F(WorldLoopTest, AStepsStagesSumToTheWhole) {
  constexpr std::uint32_t kBalls = 300;
  constexpr std::uint64_t kRounds = 40;
  push_rounds(kBalls, kRounds);
  start({.step_ns = 0, .recovery_ns = 0, .limits = {}});
  EXPECT_TRUE(books.wait([&] { return books.status.applied_sequences == std::vector<std::uint64_t>{sequence}; }));
  const std::vector<StepTrace> traces = loop->traces().newest(StepTraces::kMost);
  ASSERT_GE(traces.size(), kRounds);
  std::int64_t whole_ns = 0;
  std::int64_t in_stages_ns = 0;
  std::uint64_t moved = 0;
  for (const StepTrace& step : traces) {
    const std::int64_t sum_ns =
        step.take_ns + step.update_ns + step.index_ns + step.test_ns + step.events_ns + step.publish_ns;
    for (const std::int64_t ns : {step.take_ns, step.update_ns, step.index_ns, step.test_ns, step.events_ns})
      EXPECT_GE(ns, 0) << "step " << step.version;
    EXPECT_LE(sum_ns, step.whole_ns) << "step " << step.version << ": no time is in two stages";
    whole_ns += step.whole_ns;
    in_stages_ns += sum_ns;
    moved += step.moved;
  }
  EXPECT_GE(in_stages_ns, whole_ns - whole_ns / 10) << "time that no stage accounts for";
  EXPECT_EQ(moved, loop->sums().pairs.moved.get());
  for (std::size_t i = 1; i < traces.size(); ++i) EXPECT_GT(traces[i].version, traces[i - 1].version);
  EXPECT_EQ(loop->traces().newest(3).front().version, traces[traces.size() - 3].version);
}

// What commands had added is waited for however long it takes; the wait for publishers ends.
TEST_F(WorldLoopTest, AfterACrashItIsNotReadyWhileScenesAreAddedAgain) {
  expect_to_wait_for_adding({.step_ns = 0, .recovery_ns = 1, .limits = {}});
}

// The publishers of a server that was stopped are not waited for, and no sentence says that one is missing.
TEST_F(WorldLoopTest, AfterAStopItIsReadyAsSoonAsScenesAreAddedAgain) {
  expect_to_wait_for_adding({.step_ns = 0, .restores = true, .limits = {}});
  EXPECT_EQ(books.notices, "");
}

TEST_F(WorldLoopTest, AfterACrashItSaysThatItRecovers) {
  start({.step_ns = 0, .recovery_ns = 300'000'000, .limits = {}});
  EXPECT_TRUE(books.wait([&] { return books.statuses > 0; }));
  EXPECT_TRUE(loop->recovering());
  EXPECT_TRUE(books.wait([&] { return books.status.state == ServerState::ready; }));
  EXPECT_FALSE(loop->recovering());
}

// A way so long that its roundings hide everything on it: the step does not look for contacts on it for long, and says so.
TEST_F(WorldLoopTest, AWayThatCannotBeFollowedIsSaid) {
  start();
  define(1, {0, 0, 0}, false, {{}, std::make_shared<const TriangleMesh>(scenes::icosphere(2, 1))});
  define(2, {-9e289, 0, 0}, false, {{Box{.center = Vec3::Zero(), .half_m = {1, 2, 1}}}, nullptr});
  move(2, {9e289, 0, 0});
  EXPECT_TRUE(
      books.wait([&] { return books.notices.find("could not be followed from pose to pose") != std::string::npos; }));
}

// Every pose that came is in one of the two counts, and every object in those that it belongs to.
TEST_F(WorldLoopTest, TheStatusCountsEverything) {
  Scene scene{.name = "hall"};
  scene.mesh.vertices = {{-9, -9, -50}, {9, -9, -50}, {0, 9, -50}};
  scene.mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
  scene.parts = {{.name = "hall/floor", .first_triangle = 0, .triangle_count = 2, .filter = {}}};
  ASSERT_TRUE(std::holds_alternative<std::uint32_t>(world.add_scene(World::index_scene(scene, {}))));
  questions.answered = 31;
  questions.refused = 32;
  questions.undecided = 33;
  define(1, {0, 0, 0});
  define(2, {5, 0, 0});
  move(9, {0, 0, 1});                                         // of nobody
  move(1, {std::numeric_limits<double>::quiet_NaN(), 0, 0});  // refused
  move(1, {0, 0, 1});
  sequence -= 1;
  move(1, {0, 0, 2});  // the same number again: late
  const std::size_t batches = InboxLimits{}.batches;
  for (std::size_t i = 4; i < batches; ++i) move(1, {0, 0, 3});
  for (int i = 0; i < 3; ++i) move(1, {0, 0, 4});  // two of them are superseded
  auto malformed = inbox.spare();
  malformed->publisher = 7;
  malformed->incarnation = 1;
  malformed->object_numbers = {1, 2};
  malformed->poses.clear();
  inbox.push(std::move(malformed));  // two dropped
  start();
  // What was merged leaves a gap of numbers, which is waited for before it is given up.
  const std::vector<std::uint64_t> applied{sequence};
  EXPECT_TRUE(books.wait(
      [&] { return books.status.poses_applied == batches - 2 && books.status.applied_sequences == applied; }));
  const std::lock_guard lock(books.mutex);
  EXPECT_EQ(books.status.poses_dropped, 7U);
  EXPECT_EQ(books.status.object_count, 3U);
  EXPECT_EQ(books.status.moving_count, 2U);
  EXPECT_EQ(books.status.static_triangles, 2U);
  EXPECT_EQ(books.status.scenes, "hall");
  EXPECT_EQ(books.status.questions_answered, 31U);
  EXPECT_EQ(books.status.questions_refused, 32U);
  EXPECT_EQ(books.status.undecided_answers, 33U);
  EXPECT_EQ(books.status.publishers, std::vector<std::uint64_t>{7});
  EXPECT_EQ(books.status.publisher_states, std::vector<std::uint8_t>{0});
  EXPECT_FALSE(books.status.contacts_truncated);
  EXPECT_GT(books.status.stamp.version, 0U);
  EXPECT_GT(books.status.stamp.world_time_ns, 0);
}

}  // namespace
}  // namespace collided::engine::service
