#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "idl/topics.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine::service {

/// A question that a client asked, and the first hit of its answer.
struct SampledQuestion {
  std::uint64_t sequence = 0;  // from 1
  std::uint64_t client = 0;    // the sender
  std::int64_t taken_ns = 0;   // steady clock
  QuestionKind kind = QuestionKind::ray;
  std::array<double, kBoxNumbers> numbers{};  // its row, of the kind's length
  Verdict verdict = Verdict::miss;
  bool has_hit = false;
  AnswerHit hit = {};
  std::array<char, wire_contract::kMaxNameBytes + 1> object{};  // the hit's, zero-terminated
};

/// A few of the questions that clients ask, for clients that display them: at most one every 50 ms, from the first
/// message of questions that arrives then; the clock's last digits select one of a batch. Sweeps and what-ifs are not
/// sampled.
///
/// cost     without a reader, a load and a comparison for each message; from the first reader on 32 kB
/// threads  any
class QuestionSamples {
 public:
  static constexpr std::size_t kKept = 64;
  static constexpr std::int64_t kPauseNs = 50'000'000;      // from one sample to the next
  static constexpr std::int64_t kReaderNs = 2'000'000'000;  // a reader that has not read for this long is gone

  /// Whether a message of questions that was taken at this time is sampled.
  bool wants(std::int64_t taken_ns) const { return taken_ns >= next_ns_.load(std::memory_order_relaxed); }
  /// Keeps one of the questions of a message. Allocates nothing and never waits: if another thread is here the message
  /// is left out.
  ///
  /// given  their answers on `state`, at least one
  void take(const Snapshot& state, const Questions& asked, const Answers& given, std::uint64_t client,
            std::int64_t taken_ns);
  /// The kept samples after the one numbered `since`, without the reader's own, oldest first. Questions are sampled
  /// from the first call on, until kReaderNs after the last one.
  std::vector<SampledQuestion> read(std::uint64_t since, std::uint64_t reader, std::int64_t now_ns);

 private:
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

  std::atomic<std::int64_t> next_ns_{kNever};
  std::mutex mutex_;  // guards the members below
  std::int64_t read_ns_ = 0;
  std::uint64_t count_ = 0;
  std::unique_ptr<std::array<SampledQuestion, kKept>> kept_;  // by sequence; null: never read
};

}  // namespace collided::engine::service
