#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "server/service/runtime/duration_counts.hpp"

namespace collided::engine::service {

/// What the answering side did; added to by any thread, read for the status.
struct QuestionCounts {
  std::atomic<std::uint64_t> answered{0};
  std::atomic<std::uint64_t> refused{0};    // requests, or chunks of them
  std::atomic<std::uint64_t> undecided{0};  // answers
  // By QuestionKind and the highest rung of the ladder that one of the question's tests needed.
  std::array<std::array<std::atomic<std::uint64_t>, 3>, 7> levels{};
  std::array<DurationCounts, 7> durations{};    // by kind, from taking a chunk of questions to writing its answers
  std::atomic<std::uint64_t> float_repairs{0};  // threads whose floating-point settings had to be set back
  std::atomic<std::uint64_t> unanswerable{0};   // no room for another client, or nobody listened for the reply
};

}  // namespace collided::engine::service
