#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cstddef>

#include "idl/topics.hpp"

namespace collided::client {

/// How many chunks of a request may be under way. All that a server is to answer next lies in one buffer of its
/// machine: fifty clients with four chunks each overflow it, and what it drops is sent again and again. So a request begins
/// with one, sends more while its chunks are taken up soon, and fewer while they wait for those of many others; a server
/// with many clients is busy with one of each.
/// Not: less for chunks that are slow to compute, since a server computes several at a time.
/// source  additive increase and decrease by what was waited for: after Jain 1989, "A delay-based approach for congestion
///         avoidance"
class SendWindow {
 public:
  using Clock = std::chrono::steady_clock;

  /// In 1 ... kChunksInFlight.
  std::size_t size() const { return size_; }

  /// A chunk goes out. Of those under way the oldest counts as the next one answered.
  void note_sent(Clock::time_point now) { sent_[sent_count_++ % sent_.size()] = now; }

  /// A chunk is answered for which the server worked for compute.
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
  static constexpr int kManyChunks = 2 * kMost;  // nor for those of one other client

  std::array<Clock::time_point, kMost> sent_{};
  std::size_t sent_count_ = 0;
  std::size_t answered_count_ = 0;
  std::size_t size_ = kFirst;
};

}  // namespace collided::client
