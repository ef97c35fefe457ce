#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "idl/dds.hpp"
#include "server/service/questions/participants.hpp"
#include "server/service/questions/snapshot_leases.hpp"

namespace collided::engine::service {

/// One chunk of a request on its way from the listener to a worker.
struct Ask {
  dds::Sample<wire::Query> query;
  std::int64_t taken_ns = 0;        // when the listener took it, steady clock
  QuerySender from;                 // its sender
  std::uint64_t owner = 0;          // the owner of its client's number: the query writer; with keys the participant
  bool passed_barrier = false;      // its write barrier is behind it
  std::string refusal;              // decided before a worker takes it; empty: none
  std::int64_t retry_after_ns = 0;  // of a refusal: asking again after this long may help; 0: it does not
  SnapshotLeases::Hold hold;        // the state on which all chunks of its request are answered; none: the newest
  bool is_costly = false;           // one of its questions takes longer than workers have for one
  bool is_part = false;             // another ask has the other questions of its chunk
  std::size_t answered = 0;         // questions whose answers have left, in earlier turns
  std::shared_ptr<const Snapshot> past;  // of its instant, once looked up; null: it asks about the newest state

  /// Clears all but the query, which the next question overwrites.
  void reset();
};
using AskPointer = std::unique_ptr<Ask>;

/// Asks for reuse: they keep their memory, so taking a question allocates nothing once the pool has enough of them.
///
/// threads  any
class AskPool {
 public:
  AskPool();
  /// Returns a reset ask, a new one if none is left.
  AskPointer get();
  void put(AskPointer ask);

 private:
  static constexpr std::size_t kMost = 256;  // kept
  // Largest ask that is kept. A chunk of questions has up to 112 kB; a message may have 1 MB in any of its columns.
  static constexpr std::size_t kMostBytes = 160'000;
  static constexpr std::size_t kAtFirst = 16;
  std::mutex mutex_;
  std::vector<AskPointer> spares_;
};

/// Whether a chunk is a whole request of one question.
bool is_single(const wire::Query& query);

/// Estimated work of a chunk, in rays; a command counts as a thousand.
double cost_of(const wire::Query& query);

/// The reason why a chunk cannot be answered, as a sentence with the value and the limit; nothing if it can.
std::optional<std::string> why_refused(const wire::Query& query);

}  // namespace collided::engine::service
