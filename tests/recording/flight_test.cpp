// The ring of what came in, the window kept of it, and the file written from them.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <thread>
#include <vector>

#include "idl/mcap/reader.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/recording/flight_samples.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided::engine::service {
namespace {

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
  bool gives_back = false;
  const auto drain = [&] {
    gives_back = !gives_back;
    ring.drain(gives_back, [&](std::span<const std::byte> record) {
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
  for (const bool gives_back : {false, true}) {
    FlightRing ring(1 << 14);
    const dds::Sample<wire::Definition> sample = definition(1, 1, 1);
    EXPECT_FALSE(ring.is_filling());
    for (int i = 0; i < 400; ++i) ring.put(1, *sample, 0, 0);
    EXPECT_TRUE(ring.is_filling());
    std::uint64_t seen = 0;
    const auto count = [&](std::span<const std::byte>) { ++seen; };
    ring.drain(gives_back, count);
    EXPECT_GT(seen, 40U);
    EXPECT_EQ(seen + ring.dropped(), 400U);
    const std::uint64_t dropped = ring.dropped();
    // Several times around, a few at a time.
    for (int i = 0; i < 1'000; ++i) {
      ring.put(1, *sample, 0, 0);
      if (i % 10 == 9) ring.drain(gives_back, count);
    }
    EXPECT_EQ(ring.dropped(), dropped) << "room is free again";
    EXPECT_EQ(seen + dropped, 1'400U);
  }
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

// What a flood has filled is given back once it is older than the window.
TEST(FlightWindow, PagesOfBlocksThatExpiredAreGivenBack) {
  const auto resident_pages = [] {
    std::size_t size = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> size >> resident;
    return resident;
  };
  FlightWindow window(1'000'000, [](std::span<const std::byte>) {});
  const std::vector<std::byte> record(1 << 20);
  for (std::uint64_t time = 1; time <= 2 * FlightWindow::kBlocks; ++time) window.add(record, time);
  const std::size_t filled = resident_pages();
  window.expire(3'000'000);
  const std::size_t blocks = FlightWindow::kBlocks * FlightWindow::kBlockBytes;
  EXPECT_LT(resident_pages() + blocks / sysconf(_SC_PAGESIZE) * 9 / 10, filled);
  window.add(record, 3'000'001);
  std::size_t kept = 0;
  window.for_each_block(
      [&](std::span<const std::byte> records, std::uint64_t, std::uint64_t) { kept += records.size(); });
  EXPECT_EQ(kept, record.size());
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

/// Far more than passes between the last note and the file, on a machine with more to do than it can as well.
constexpr std::chrono::nanoseconds kWindow = std::chrono::seconds(2);
/// Until what was noted so far lies before the window.
void let_it_leave_the_window() { std::this_thread::sleep_for(kWindow + std::chrono::milliseconds(100)); }

TEST(FlightRecorder, AFileBeginsWithTheStateBeforeItsWindow) {
  const Folder folder;
  FlightRecorder recorder("hall", 60'000'000'000, folder.stem());
  recorder.note(Recorded::object, *definition(7, 0, 1));
  recorder.note(Recorded::pose, *batch(7, 2, 1, 0.5));
  let_it_leave_the_window();
  recorder.note(Recorded::pose, *batch(7, 3, 1, 0.75));
  const FlightFile file = recorder.write("a", kWindow.count());
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

// A command of the window is there as it was asked, and so is one that the server gave itself; those before are in the opening.
TEST(FlightRecorder, AFileHasEachCommandOnceAndNoChanges) {
  const Folder folder;
  FlightRecorder recorder("hall", 60'000'000'000, folder.stem());
  const auto added = [](const std::string& name, std::uint64_t client, std::uint64_t request) {
    return Inventory::Changes{
        .erased = {}, .put = {{.key = {KeptKind::object, name}, .text = name}}, .client = client, .request = request};
  };
  recorder.note(Recorded::query, *command(R"({"command":"add","name":"crate"})", 1));
  recorder.note_changes(added("crate", 5, 1));
  recorder.note_own("own", {});
  recorder.note_changes(added("own", 0, 0));
  let_it_leave_the_window();
  recorder.note(Recorded::query, *command(R"({"command":"add","name":"ball"})", 2));
  recorder.note_changes(added("ball", 5, 2));
  recorder.note_own(R"({"command":"add","name":"lid"})", {});
  recorder.note_changes(added("lid", 0, 0));
  const std::vector<std::byte> bytes = mcap::read_file(recorder.write("a", kWindow.count()).path, 1 << 20);
  const mcap::Contents contents = mcap::read(bytes);
  std::vector<std::string> commands;
  for (const mcap::Message& message : contents.messages) {
    dds::Sample<wire::Query> query;
    EXPECT_EQ(contents.channels.at(message.head.channel).topic, "hall/query_v2");
    ASSERT_TRUE(wire::read_cdr(message.data, query));
    commands.emplace_back(query->text);
  }
  EXPECT_EQ(contents.metadata.at("recording").at("opening_messages"), "2");
  EXPECT_EQ(commands, (std::vector<std::string>{"crate", "own", R"({"command":"add","name":"ball"})",
                                                R"({"command":"add","name":"lid"})"}));
}

// What was written of a file that found no room stayed, and kept the room that the journal needs.
TEST(FlightRecorder, AFileThatDoesNotFitLeavesNothing) {
  const Folder folder;
  FlightRecorder recorder("hall", 60'000'000'000, folder.stem());
  for (std::uint64_t i = 1; i <= 100; ++i) recorder.note(Recorded::pose, *batch(7, i, 1, 0.5));
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{.rlim_cur = 4'096, .rlim_max = before.rlim_max};
  const auto handled = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(recorder.write("a", 60'000'000'000), std::runtime_error);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handled);
  EXPECT_FALSE(std::filesystem::exists(folder.stem() + "_a.mcap"));
  EXPECT_GT(recorder.write("a", 60'000'000'000).bytes, 4'096U) << "with room it is written";
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
