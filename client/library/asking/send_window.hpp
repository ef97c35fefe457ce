#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>

#include "idl/topics.hpp"

namespace collided::client {

/// The number of chunks of a request that may be in flight. All chunks for a server wait in one buffer of its machine:
/// fifty clients with four chunks each overflow it, and dropped chunks are sent again and again. Therefore a request
/// begins with one chunk, sends more while its chunks are taken soon, and fewer while they wait for those of many
/// others; one chunk per client keeps a server with many clients busy. Slow computation does not shrink the window,
/// since a server computes several chunks at a time.
/// source  additive increase and decrease by the waiting time: after Jain 1989, "A delay-based approach for congestion
///         avoidance"
class SendWindow {
 public:
  using Clock = std::chrono::steady_clock;

  /// In 1 ... kChunksInFlight.
  std::size_t size() const { return size_; }

  /// Notes that a chunk is sent. The oldest chunk in flight counts as the next one answered.
  void note_sent(Clock::time_point now) { sent_[sent_count_++ % sent_.size()] = now; }

  /// Notes the answer to a chunk on which the server worked for `compute`.
  void note_answered(Clock::time_point now, std::chrono::nanoseconds compute) {
    if (answered_count_ == sent_count_) return;
    const std::chrono::nanoseconds waited = now - sent_[answered_count_++ % sent_.size()] - compute;
    if (waited <= std::max(kPrompt, kOwnChunks * compute)) size_ = std::min(size_ + 1, kMost);
    else if (waited > std::max(kLate, kManyChunks * compute)) size_ = std::max(size_ - 1, std::size_t{1});
  }

 private:
  static constexpr std::size_t kMost = wire_contract::kChunksInFlight;
  static constexpr std::size_t kFirst = 1;
  static constexpr std::chrono::nanoseconds kPrompt = std::chrono::milliseconds{10};
  static constexpr std::chrono::nanoseconds kLate = std::chrono::milliseconds{20};
  static constexpr int kOwnChunks = kMost;       // a request's own chunks wait for each other
  static constexpr int kManyChunks = 2 * kMost;  // and for those of one other client

  std::array<Clock::time_point, kMost> sent_{};
  std::size_t sent_count_ = 0;
  std::size_t answered_count_ = 0;
  std::size_t size_ = kFirst;
};

}  // namespace collided::client
