#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/recording/recorded_topics.hpp"
#include "idl/topics.hpp"

namespace collided::client {

/// Serialized samples that wait for the disk, from DDS's threads to the writing thread.
///
/// limit    at most kMostBytes wait; further samples are dropped and counted
/// threads  any may put; one takes
class RecordingQueue {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20;
  static constexpr std::size_t kTopics = recording::kRecordedTopics.size();
  static constexpr std::size_t kMostOwn = 8;  // additional channels of the recording program
  static constexpr std::size_t kChannels = kTopics + kMostOwn;

  /// A sample; times are ns since 1970.
  struct Entry {
    std::uint16_t channel = 0;
    std::uint64_t log_time = 0;
    std::uint64_t publish_time = 0;
    std::size_t begin = 0, size = 0;        // of its data in the batch's bytes
    std::uint64_t client = 0, request = 0;  // of a command
  };
  struct Batch {
    std::vector<Entry> entries;
    std::vector<std::byte> bytes;
  };

  template <class T>
  void put(recording::Recorded topic, const T& sample, std::uint64_t log_time, std::uint64_t publish_time) {
    Entry entry{.channel = static_cast<std::uint16_t>(topic), .log_time = log_time, .publish_time = publish_time};
    if constexpr (std::is_same_v<T, wire::Query>) {
      if (sample.kind == static_cast<std::uint8_t>(wire_contract::QuestionKind::command))
        entry.client = sample.client, entry.request = sample.request;
    }
    put(entry, wire::cdr_size(sample), [&](std::span<std::byte> room) { wire::write_cdr(sample, room); });
  }
  /// channel  number in the file of an additional channel
  void put(std::uint16_t channel, std::string_view text, std::uint64_t log_time) {
    put({.channel = channel, .log_time = log_time, .publish_time = log_time}, text.size(),
        [&](std::span<std::byte> room) { std::ranges::copy(std::as_bytes(std::span(text)), room.begin()); });
  }

  /// Swaps the waiting samples into `batch` as soon as they have 1 MiB, after `wait`, or after wake().
  void take(Batch& batch, std::chrono::nanoseconds wait);
  void wake();
  /// Number of dropped samples by channel; index 0 is the first topic.
  std::array<std::uint64_t, kChannels> dropped() const;

 private:
  template <class Write>
  void put(Entry entry, std::size_t size, const Write& write) {
    const std::lock_guard lock(mutex_);
    entry.begin = waiting_.bytes.size();
    entry.size = size;
    if (entry.begin + size > kMostBytes) {
      ++dropped_[entry.channel - std::size_t{1}];
      return;
    }
    waiting_.bytes.resize(entry.begin + size);
    write(std::span(waiting_.bytes).subspan(entry.begin));
    waiting_.entries.push_back(entry);
    if (entry.begin + size >= kWakeBytes) came_.notify_one();
  }

  static constexpr std::size_t kWakeBytes = std::size_t{1} << 20;
  mutable std::mutex mutex_;
  std::condition_variable came_;
  bool woken_ = false;
  Batch waiting_;
  std::array<std::uint64_t, kChannels> dropped_{};
};

}  // namespace collided::client
