#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "idl/topics.hpp"
#include "server/service/runtime/duration_counts.hpp"

namespace collided::engine::service {

/// Counts of answering since the start. Any thread adds; read for the status and the figures.
struct QuestionCounts {
  std::atomic<std::uint64_t> answered{0};
  std::atomic<std::uint64_t> refused{0};    // requests, or single chunks of them
  std::atomic<std::uint64_t> undecided{0};  // answers
  static constexpr std::size_t kKinds = wire_contract::kCodeCount<wire_contract::QuestionKind>;
  // By QuestionKind, then by the level that decided the question: 0 filter in double, 1 error-free sums, 2 rationals.
  std::array<std::array<std::atomic<std::uint64_t>, 3>, kKinds> levels{};
  std::array<DurationCounts, kKinds> durations{};  // by QuestionKind, from taking a chunk to writing its answers
  std::atomic<std::uint64_t> float_repairs{0};     // times that a thread's floating-point settings had to be restored
  std::atomic<std::uint64_t> filters_dropped{0};   // name patterns whose filter was evicted for another's
  std::atomic<std::uint64_t> unanswerable{0};      // no room for the client or the refusal, or no reader of the reply
};

}  // namespace collided::engine::service
