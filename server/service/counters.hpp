#pragma once

#include <atomic>
#include <cstdint>

namespace collided::service {

/// What the answering side did; added to by any thread, read for the status.
struct QuestionCounts {
  std::atomic<std::uint64_t> answered{0};
  std::atomic<std::uint64_t> refused{0};       // requests, or chunks of them
  std::atomic<std::uint64_t> undecided{0};     // answers
  std::atomic<std::uint64_t> unanswerable{0};  // no room for another client, or nobody listened for the reply
};

}  // namespace collided::service
