#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include "idl/mcap/reader.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/service/wire_rows.hpp"

namespace collided::engine::service {
namespace {

using recording::Recorded;

class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "flight_XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  std::string stem() const { return path_ + "/server"; }

 private:
  std::string path_;
};

/// Of `count` objects numbered from 0, all at x.
dds::Sample<wire::PoseBatch> batch(std::uint64_t publisher, std::uint64_t sequence, std::uint32_t count, double x) {
  dds::Sample<wire::PoseBatch> sample;
  sample->publisher = publisher;
  sample->incarnation = 1;
  sample->sequence_number = sequence;
  std::vector<std::uint32_t> numbers(count);
  std::vector<double> poses;
  for (std::uint32_t i = 0; i < count; ++i) {
    numbers[i] = i;
    poses.insert(poses.end(), {x, 0, 0, 1, 0, 0, 0});
  }
  dds::borrow(sample->object_numbers, numbers);
  test::put_poses(*sample, poses);
  std::vector<std::byte> bytes(wire::cdr_size(*sample));
  wire::write_cdr(*sample, bytes);
  dds::Sample<wire::PoseBatch> owner;  // of its sequences
  EXPECT_TRUE(wire::read_cdr(std::span<const std::byte>(bytes), owner));
  dds::borrow(sample->object_numbers, std::span<const std::uint32_t>());
  return owner;
}

dds::Sample<wire::Definition> definition(std::uint64_t publisher, std::uint32_t number, std::uint64_t sequence,
                                         bool removed = false) {
  dds::Sample<wire::Definition> sample;
  sample->publisher = publisher;
  sample->object_number = number;
  sample->incarnation = 1;
  sample->sequence_number = sequence;
  sample->removed = removed;
  EXPECT_TRUE(dds::set_text(sample->name, "object " + std::to_string(number)));
  return sample;
}

dds::Sample<wire::Query> command(const std::string& text, std::uint64_t request = 0) {
  dds::Sample<wire::Query> sample;
  sample->client = request == 0 ? 0 : 5;
  sample->request = request;
  sample->kind = static_cast<std::uint8_t>(wire_contract::QueryKind::command);
  sample->chunk_count = 1;
  EXPECT_TRUE(dds::set_text(sample->text, text));
  return sample;
}

// Several threads put into a ring that wraps many times, one drains: what comes out is what each put, in its order.
TEST(FlightRing, SeveralThreadsPutAndNothingIsMissingOrMadeUp) {
  constexpr std::size_t kThreads = 4;
  constexpr std::uint64_t kEach = 2'000;
  constexpr std::uint64_t kMostAhead = 100;  // of at most 600 bytes each: room for all of them
  FlightRing ring(1 << 17);
  std::atomic<std::size_t> running{kThreads};
  std::atomic<std::uint64_t> put{0}, seen{0};
  std::vector<std::thread> threads;
  for (std::size_t thread = 0; thread < kThreads; ++thread) {
    threads.emplace_back([&, thread] {
      dds::Sample<wire::EventFrame> sample;
      std::vector<double> numbers;
      for (std::uint64_t i = 0; i < kEach; ++i) {
        sample->server = thread;
        sample->first_sequence = i;
        numbers.assign(i % 50, static_cast<double>(i));
        dds::borrow(sample->depths, numbers);
        while (put.load() - seen.load() > kMostAhead) std::this_thread::yield();
        ring.put(5, *sample, i, thread);
        ++put;
      }
      dds::borrow(sample->depths, std::span<const double>());
      --running;
    });
  }
  std::map<std::uint64_t, std::uint64_t> next;
  std::uint64_t wrong = 0;
  const auto drain = [&] {
    ring.drain([&](std::span<const std::byte> record) {
      dds::Sample<wire::EventFrame> sample;
      ++seen;
      if (!wire::read_cdr(record.subspan(mcap::kMessagePrefixBytes), sample)) {
        ++wrong;
        return;
      }
      const auto numbers = dds::view(sample->depths);
      const bool whole = numbers.size() == sample->first_sequence % 50 &&
                         std::all_of(numbers.begin(), numbers.end(), [&](double number) {
                           return number == static_cast<double>(sample->first_sequence);
                         });
      const bool in_order = sample->first_sequence == next[sample->server];
      wrong += whole && in_order ? 0 : 1;
      next[sample->server] = sample->first_sequence + 1;
    });
  };
  while (running > 0) drain();
  for (std::thread& thread : threads) thread.join();
  drain();
  EXPECT_EQ(wrong, 0U);
  EXPECT_EQ(seen, kThreads * kEach);
  EXPECT_EQ(ring.dropped(), 0U);
}

TEST(FlightRing, AFullRingDropsAndCounts) {
  FlightRing ring(1 << 12);
  const dds::Sample<wire::Definition> sample = definition(1, 1, 1);
  for (int i = 0; i < 100; ++i) ring.put(1, *sample, 0, 0);
  std::uint64_t seen = 0;
  ring.drain([&](std::span<const std::byte>) { ++seen; });
  EXPECT_GT(seen, 10U);
  EXPECT_EQ(seen + ring.dropped(), 100U);
  ring.put(1, *sample, 0, 0);
  ring.drain([&](std::span<const std::byte>) { ++seen; });
  EXPECT_EQ(seen + ring.dropped(), 101U) << "room is free again";
}

TEST(FlightWindow, WhatIsOldLeavesOnceAndInOrder) {
  std::vector<std::uint64_t> left;
  FlightWindow window(160, [&](std::span<const std::byte> records) {
    while (!records.empty()) {
      std::uint64_t value = 0;
      std::memcpy(&value, records.data(), sizeof value);
      left.push_back(value);
      records = records.subspan(sizeof value);
    }
  });
  for (std::uint64_t time = 1; time <= 1'000; ++time) {
    window.add(std::as_bytes(std::span(&time, 1)), time);
    window.expire(time);
  }
  std::uint64_t oldest_kept = 0, kept = 0;
  window.for_each_block([&](std::span<const std::byte> records, std::uint64_t first, std::uint64_t) {
    if (oldest_kept == 0) oldest_kept = first;
    kept += records.size() / sizeof(std::uint64_t);
  });
  EXPECT_GE(kept, 160U);
  EXPECT_LE(kept, 160U + 2 * 160 / 16);
  ASSERT_EQ(left.size() + kept, 1'000U);
  for (std::size_t i = 0; i < left.size(); ++i) ASSERT_EQ(left[i], i + 1);
  EXPECT_EQ(oldest_kept, left.size() + 1);
}

// A window of 16 blocks, the one that is being filled and the one that leaves, however long it goes on.
TEST(FlightWindow, BlocksThatLeftAreFilledAgain) {
  FlightWindow window(160, [](std::span<const std::byte>) {});
  for (std::uint64_t time = 1; time <= 10'000; ++time) {
    window.add(std::as_bytes(std::span(&time, 1)), time);
    window.expire(time);
    ASSERT_LE(window.held_bytes(), 18 * FlightWindow::kBlockBytes) << time;
  }
  EXPECT_GE(window.held_bytes(), 16 * FlightWindow::kBlockBytes);
}

// Memory is bounded: megabytes beyond it push out the oldest, however young.
TEST(FlightWindow, ABusyWindowIsShorterAndNoLarger) {
  std::uint64_t left = 0;
  FlightWindow window(1'000'000, [&](std::span<const std::byte> records) { left += records.size(); });
  const std::vector<std::byte> record(1 << 20);
  for (std::uint64_t i = 0; i < 100; ++i) window.add(record, 1);
  std::uint64_t kept = 0;
  window.for_each_block(
      [&](std::span<const std::byte> records, std::uint64_t, std::uint64_t) { kept += records.size(); });
  EXPECT_EQ(left + kept, 100U << 20);
  EXPECT_LE(kept, FlightWindow::kBlocks * FlightWindow::kBlockBytes);
}

struct Written {
  std::map<std::uint32_t, std::uint64_t> objects;  // sequence by number
  std::map<std::uint32_t, double> x;               // of the newest pose
  std::vector<std::string> commands;
  std::uint64_t newest = 0;
};
Written written(const FlightOpening& opening) {
  Written all;
  opening.write([&](Recorded topic, std::span<const std::byte> data) {
    dds::Sample<wire::Definition> definition;
    dds::Sample<wire::PoseBatch> poses;
    dds::Sample<wire::Query> query;
    if (topic == Recorded::object && wire::read_cdr(data, definition))
      all.objects[definition->object_number] = definition->sequence_number;
    if (topic == Recorded::pose && wire::read_cdr(data, poses)) {
      all.newest = poses->sequence_number;
      for (std::uint32_t i = 0; i < poses->object_numbers._length; ++i)
        all.x[poses->object_numbers._buffer[i]] = poses->positions._buffer[3 * i];
    }
    if (topic == Recorded::query && wire::read_cdr(data, query)) all.commands.emplace_back(query->text);
  });
  return all;
}

TEST(FlightOpening, IsTheNewestOfEachObjectWhateverTheOrder) {
  FlightOpening opening;
  opening.fold(*definition(7, 0, 1));
  opening.fold(*definition(7, 1, 2));
  opening.fold(*definition(7, 2, 3));
  opening.fold(*batch(7, 5, 3, 5));
  opening.fold(*batch(7, 4, 3, 4));  // late
  opening.fold(*definition(7, 1, 6, true));
  opening.fold(*batch(7, 7, 2, 7));
  const Written all = written(opening);
  EXPECT_EQ(all.objects, (std::map<std::uint32_t, std::uint64_t>{{0, 1}, {2, 3}}));
  EXPECT_EQ(all.x, (std::map<std::uint32_t, double>{{0, 7}, {2, 5}}));
  EXPECT_EQ(all.newest, 7U);
}

// Definitions and poses are on topics of their own, either may overtake the other.
TEST(FlightOpening, APoseMayComeBeforeItsObject) {
  FlightOpening opening;
  opening.fold(*batch(7, 2, 2, 4));
  opening.fold(*definition(7, 0, 1));
  opening.fold(*definition(7, 1, 3));  // anew, after the pose
  const Written all = written(opening);
  EXPECT_EQ(all.objects, (std::map<std::uint32_t, std::uint64_t>{{0, 1}, {1, 3}}));
  EXPECT_EQ(all.x, (std::map<std::uint32_t, double>{{0, 4}}));
}

// A sample of each topic with one number: the server takes the pose, so it is in the state that the file begins with.
TEST(FlightOpening, APoseWithTheNumberOfItsDefinitionIsOfIt) {
  FlightOpening opening;
  opening.fold(*definition(7, 0, 5));
  opening.fold(*batch(7, 5, 1, 9));
  EXPECT_EQ(written(opening).x, (std::map<std::uint32_t, double>{{0, 9}}));
  opening.fold(*definition(7, 0, 5));  // sent again
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{0, 5}}));
  EXPECT_EQ(written(opening).x, (std::map<std::uint32_t, double>{{0, 9}}));
  opening.fold(*batch(7, 4, 1, 8));
  EXPECT_EQ(written(opening).x, (std::map<std::uint32_t, double>{{0, 9}})) << "late";
}

// Whoever replays it must know which definitions the poses are of, and when they were.
TEST(FlightOpening, ItsPosesSayWhatTheyAreOf) {
  FlightOpening opening;
  opening.fold(*definition(7, 0, 1));
  opening.fold(*definition(7, 1, 3));
  for (const std::uint64_t sequence : {4, 2}) {  // the older one late
    dds::Sample<wire::PoseBatch> poses = batch(7, sequence, 1, 0.5);
    poses->source_time_ns = static_cast<std::int64_t>(100 * sequence);
    opening.fold(*poses);
  }
  dds::Sample<wire::PoseBatch> told;
  opening.write([&](Recorded topic, std::span<const std::byte> data) {
    if (topic != Recorded::pose) return;
    ASSERT_TRUE(wire::read_cdr(data, told));
  });
  EXPECT_EQ(told->publisher, 7U);
  EXPECT_EQ(told->incarnation, 1U);
  EXPECT_EQ(told->sequence_number, 4U);
  EXPECT_EQ(told->definitions_through, 3U);
  EXPECT_EQ(told->source_time_ns, 400);
  EXPECT_EQ(told->flags, wire_contract::kTeleported);
}

TEST(FlightOpening, ANewLifeOfAPublisherReplacesTheOld) {
  FlightOpening opening;
  opening.fold(*definition(7, 0, 9));
  dds::Sample<wire::Definition> next = definition(7, 1, 1);
  next->incarnation = 2;
  opening.fold(*next);
  opening.fold(*definition(7, 3, 10));  // of the old life
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{1, 1}}));
}

void tell(FlightOpening& opening, const std::vector<std::pair<std::uint64_t, wire_contract::PublisherState>>& listed) {
  std::vector<std::uint64_t> publishers;
  std::vector<std::uint8_t> states;
  for (const auto& [publisher, state] : listed)
    publishers.push_back(publisher), states.push_back(static_cast<std::uint8_t>(state));
  dds::Sample<wire::Status> status;
  dds::borrow(status->publishers, publishers);
  dds::borrow(status->publisher_states, states);
  opening.fold(*status);
  dds::borrow(status->publishers, std::span<const std::uint64_t>());
  dds::borrow(status->publisher_states, std::span<const std::uint8_t>());
}

/// Asks and lets the server say what it did.
void ask(FlightOpening& opening, const std::string& text, const std::string& answer = "{}",
         wire_contract::ReplyStatus status = wire_contract::ReplyStatus::ok) {
  static std::uint64_t request = 0;
  opening.fold(*command(text, ++request));
  dds::Sample<wire::Reply> reply;
  reply->client = 5;
  reply->request = request;
  reply->chunk_count = 1;
  reply->status = static_cast<std::uint8_t>(status);
  const std::vector<std::uint8_t> bytes(answer.begin(), answer.end());
  dds::borrow(reply->text, bytes);
  opening.fold(*reply);
  dds::borrow(reply->text, std::span<const std::uint8_t>());
}

using wire_contract::PublisherState;

TEST(FlightOpening, ALostPublishersObjectsGoAsItWishedAndComeBackWithIt) {
  FlightOpening opening;
  dds::Sample<wire::Definition> kept = definition(7, 1, 2);
  kept->lost_policy = static_cast<std::uint8_t>(wire_contract::LostPolicy::freeze);
  opening.fold(*definition(7, 0, 1));
  opening.fold(*kept);
  tell(opening, {{7, PublisherState::lost}});
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{1, 2}}));
  tell(opening, {{7, PublisherState::alive}});
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{0, 1}, {1, 2}}));
}

// A thousand publishers have room; those that came and went do not take it from the next.
TEST(FlightOpening, PublishersThatTheServerForgotAreForgotten) {
  FlightOpening opening;
  for (std::uint64_t publisher = 1; publisher <= 3'000; ++publisher) {
    tell(opening, {});
    opening.fold(*definition(publisher, 0, 1));
    opening.fold(*batch(publisher, 2, 1, 5));
    tell(opening, {});  // on its way: not listed yet
    EXPECT_EQ(written(opening).objects.size(), 1U);
    tell(opening, {{publisher, PublisherState::alive}});
    EXPECT_EQ(written(opening).x.at(0), 5);
    tell(opening, {});
    EXPECT_TRUE(written(opening).objects.empty());
  }
  EXPECT_EQ(opening.left_out(), 0U);
}

TEST(FlightOpening, CommandsThatUndoEachOtherTakeNoRoom) {
  FlightOpening opening;
  for (int i = 0; i < 10; ++i) {
    ask(opening, R"({"command":"add","name":"crate"})");
    ask(opening, R"({"command":"move","name":"crate","pose":[1]})");
    ask(opening, R"({"command":"move","name":"crate","pose":[2]})");
    ask(opening, R"({"command":"list"})");
    if (i < 9)
      ask(opening, i % 2 == 0 ? R"({"command":"remove","name":"crate"})" : R"({"command":"remove","name":"c*"})",
          R"({"removed":["crate"]})");
  }
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"add","name":"crate"})",
                                                                 R"({"command":"move","name":"crate","pose":[2]})"}));
  for (int i = 0; i < 10; ++i) {
    ask(opening, R"({"command":"load","path":"/a/plate.obj"})", R"({"scene":"plate"})");
    ask(opening, R"({"command":"clear","scene":"plate"})");
    ask(opening, R"({"command":"probe","name":"ear","object":"crate"})");
    ask(opening, R"({"command":"probe","name":"e*","remove":true})", R"({"probes":["ear"]})");
  }
  EXPECT_EQ(written(opening).commands.size(), 2U);
  ask(opening, R"({"command":"clear"})");
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"clear"})"}))
      << "the scenes of the start are gone too";
}

TEST(FlightOpening, WhatWasRefusedChangedNothing) {
  FlightOpening opening;
  ask(opening, R"({"command":"add","name":"crate"})");
  ask(opening, R"({"command":"remove","name":"*"})", "a living publisher has one", wire_contract::ReplyStatus::refused);
  ask(opening, R"({"command":"load","path":"/nowhere.obj"})", "no such file", wire_contract::ReplyStatus::refused);
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"add","name":"crate"})"}));
}

// What the server carried out is taken as it stands, whatever its text; one that cannot be read says nothing of objects.
TEST(FlightOpening, ACommandWhoseTextIsNoJsonIsSurvived) {
  FlightOpening opening;
  ask(opening, R"({"command":"add","name":"crate"})");
  ask(opening, R"({"command":"remove","na)", R"({"removed":["crate"]})");
  ask(opening, R"({"command":"remove","name":"crate"})", R"({"removed":["cra)");
  ask(opening, R"({"command":"add","name":"ball"})");
  const std::vector<std::string> commands = written(opening).commands;
  ASSERT_FALSE(commands.empty());
  EXPECT_EQ(commands.back(), R"({"command":"add","name":"ball"})");
}

TEST(FlightOpening, WhatIsNoNameAmongTheRemovedIsPassedOver) {
  FlightOpening opening;
  ask(opening, R"({"command":"add","name":"crate"})");
  ask(opening, R"({"command":"remove","name":"*"})", R"({"removed":[1,null,"crate",{"name":"ball"},"door"]})");
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"remove","name":"door"})"}));
}

TEST(FlightOpening, AnObjectOfASceneStaysAwayOnceItWasRemoved) {
  FlightOpening opening;
  for (int i = 0; i < 3; ++i) {
    ask(opening, R"({"command":"load","path":"/a/hall.obj","replace":true})", R"({"scene":"hall"})");
    ask(opening, R"({"command":"remove","name":"door?"})", R"({"removed":["door1","door2"]})");
  }
  EXPECT_EQ(
      written(opening).commands,
      (std::vector<std::string>{R"({"command":"load","path":"/a/hall.obj","replace":true})",
                                R"({"command":"remove","name":"door1"})", R"({"command":"remove","name":"door2"})"}));
}

TEST(FlightOpening, WhatALostPublisherLeftCanBeRemovedAndOfALivingOneNothing) {
  FlightOpening opening;
  for (const std::uint64_t publisher : {7, 8}) {
    dds::Sample<wire::Definition> frozen = definition(publisher, 10 + static_cast<std::uint32_t>(publisher), 1);
    frozen->lost_policy = static_cast<std::uint8_t>(wire_contract::LostPolicy::freeze);
    opening.fold(*frozen);
  }
  tell(opening, {{7, PublisherState::lost}, {8, PublisherState::alive}});
  ask(opening, R"({"command":"remove","name":"object 17"})", R"({"removed":["object 17"]})");
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{18, 1}}));
  EXPECT_TRUE(written(opening).commands.empty());
  ask(opening, R"({"command":"clear"})");
  EXPECT_EQ(written(opening).objects, (std::map<std::uint32_t, std::uint64_t>{{18, 1}}));
}

// What the window's end cuts off from its answer is written, and so is what the server carried out by itself.
TEST(FlightOpening, ACommandWithoutAnAnswerIsWrittenLast) {
  FlightOpening opening;
  opening.fold(*command(R"({"command":"add","name":"late"})", 1'000'000));
  opening.fold(*command(R"({"command":"add","name":"from the journal"})"));
  EXPECT_EQ(written(opening).commands, (std::vector<std::string>{R"({"command":"add","name":"from the journal"})",
                                                                 R"({"command":"add","name":"late"})"}));
  for (std::uint64_t i = 0; i < 200; ++i) opening.fold(*command(R"({"command":"add","name":"lost"})", 2'000'000 + i));
  EXPECT_EQ(written(opening).commands.size(), 1 + FlightCommands::kMostUnanswered);
  EXPECT_EQ(opening.left_out(), 201 - FlightCommands::kMostUnanswered);
}

// What has left the window comes back as the state that the file begins with.
/// The contacts of a shard after an event, each of this size at least.
void hold(FlightOpening& opening, std::uint8_t shard, std::uint64_t as_of, std::size_t count,
          std::size_t name_bytes = 0) {
  std::vector<std::uint64_t> ids(count, 7);
  const std::vector<std::uint8_t> names(name_bytes, 'x');
  dds::Sample<wire::ContactShard> sample;
  sample->shard = shard;
  sample->as_of_sequence = as_of;
  dds::borrow(sample->a, ids);
  dds::borrow(sample->names, names);
  opening.fold(*sample);
}

/// As of when each shard was written.
std::map<std::uint8_t, std::uint64_t> held(const FlightOpening& opening) {
  std::map<std::uint8_t, std::uint64_t> shards;
  opening.write([&](Recorded topic, std::span<const std::byte> data) {
    dds::Sample<wire::ContactShard> sample;
    if (topic == Recorded::contact && wire::read_cdr(data, sample)) shards[sample->shard] = sample->as_of_sequence;
  });
  return shards;
}

TEST(FlightOpening, HasTheContactsThatHeld) {
  FlightOpening opening;
  hold(opening, 3, 10, 1);
  hold(opening, 5, 11, 1);
  hold(opening, 3, 12, 2);
  hold(opening, 5, 13, 0);
  EXPECT_EQ(held(opening), (std::map<std::uint8_t, std::uint64_t>{{3, 12}}));
}

// An old sample would be a lie: it goes also where the new one has no room.
TEST(FlightOpening, ContactsThatHaveNoRoomAreLeftOutAndCounted) {
  FlightOpening opening;
  for (std::uint8_t shard = 0; shard < 16; ++shard) hold(opening, shard, 1, 1, 1'000'000);
  EXPECT_EQ(held(opening).size(), 16U);
  EXPECT_EQ(opening.left_out(), 0U);
  hold(opening, 4, 2, 1, 2'000'000);
  EXPECT_EQ(held(opening).count(4), 0U);
  EXPECT_EQ(opening.left_out(), 1U);
  hold(opening, 4, 3, 1, 1'000'000);
  EXPECT_EQ(held(opening).size(), 16U) << "there is room again";
}

TEST(FlightRecorder, AFileBeginsWithTheStateBeforeItsWindow) {
  const Folder folder;
  FlightRecorder recorder("hall", 60'000'000'000, folder.stem());
  recorder.note(Recorded::object, *definition(7, 0, 1));
  recorder.note(Recorded::pose, *batch(7, 2, 1, 0.5));
  const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(300)); };
  wait();  // so that the two lie before the last 0.2 s
  recorder.note(Recorded::pose, *batch(7, 3, 1, 0.75));
  const FlightFile file = recorder.write("a", 200'000'000);
  const std::vector<std::byte> bytes = mcap::read_file(file.path, 1 << 20);
  const mcap::Contents contents = mcap::read(bytes);
  ASSERT_TRUE(contents.complete);
  EXPECT_EQ(contents.metadata.at("recording").at("opening_messages"), "2");
  ASSERT_EQ(contents.messages.size(), 3U);
  EXPECT_EQ(contents.channels.at(contents.messages[0].head.channel).topic, "hall/object_v2");
  dds::Sample<wire::PoseBatch> before, after;
  ASSERT_TRUE(wire::read_cdr(contents.messages[1].data, before));
  ASSERT_TRUE(wire::read_cdr(contents.messages[2].data, after));
  EXPECT_EQ(before->positions._buffer[0], 0.5);
  EXPECT_EQ(after->positions._buffer[0], 0.75);
  EXPECT_EQ(file.dropped, 0U);
}

TEST(FlightRecorder, WithoutAFolderItSaysSo) {
  FlightRecorder recorder("hall", 1'000'000'000, "");
  EXPECT_THROW(recorder.write("a", 1), std::runtime_error);
}

// The thread that fails may hold anything: what was noted until then is in the file all the same, up to the last sample.
TEST(FlightRecorderDeathTest, AFatalSignalLeavesAFile) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer has these signals for itself";
#endif
  const Folder folder;
  EXPECT_DEATH(
      {
        FlightRecorder recorder("hall", 60'000'000'000, folder.stem());
        recorder.write_at_fatal_signals();
        for (std::uint64_t i = 1; i <= 100; ++i) recorder.note(Recorded::pose, *batch(7, i, 10, 1));
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        recorder.note(Recorded::pose, *batch(7, 101, 10, 1));
        std::raise(SIGSEGV);
      },
      "");
  const std::vector<std::byte> bytes = mcap::read_file(folder.stem() + "_crash.mcap", 1 << 20);
  const mcap::Contents contents = mcap::read(bytes);
  EXPECT_TRUE(contents.is_mcap);
  EXPECT_EQ(contents.bad_chunks, 0U);
  ASSERT_EQ(contents.messages.size(), 101U);
  dds::Sample<wire::PoseBatch> last;
  ASSERT_TRUE(wire::read_cdr(contents.messages.back().data, last));
  EXPECT_EQ(last->sequence_number, 101U);
}

}  // namespace
}  // namespace collided::engine::service
