#pragma once

#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "server/service/questions/ask.hpp"

namespace collided::engine::service {

/// Questions that wait until a publisher's sample is part of a published state, so that clients read their own writes.
///
/// threads  any; update() after each step, by the world's thread
class WriteBarriers {
 public:
  static constexpr std::size_t kMost = 1'024;     // questions
  static constexpr std::size_t kMostOfOne = 512;  // of one process
  static constexpr std::size_t kReserved = 256;   // of kMost, for processes ...
  static constexpr std::size_t kFew = 16;         // ... with fewer questions than this
  static constexpr std::int64_t kPatienceNs = 1'000'000'000;

  /// passed: the question may go on. parked: it waits here. full: refused, since too many wait already, in total or of
  /// its process.
  enum class Outcome : std::uint8_t { passed, parked, full };
  /// Checks the ask's barrier, and takes the ask if it is parked.
  Outcome pass(AskPointer& ask);

  /// (publisher, sequence number up to which its samples are in the newest published state), ascending by publisher.
  using Applied = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
  void update(const Applied& applied);
  /// Takes the asks whose sample has arrived, in the order in which they came.
  std::vector<AskPointer> take_ready();
  /// Takes the asks that waited longer than their deadline or kPatienceNs.
  std::vector<AskPointer> take_overdue(std::int64_t now_ns);
  /// Takes all waiting asks.
  std::vector<AskPointer> take_all();
  /// Sequence number up to which the publisher's samples are in the newest published state; 0: unknown.
  std::uint64_t applied(std::uint64_t publisher) const;
  bool empty() const;

 private:
  std::uint64_t applied_locked(std::uint64_t publisher) const;
  bool reached(const wire::Query& query) const;
  bool has_room_for(std::uint64_t participant) const;
  template <class Chosen>
  std::vector<AskPointer> take_if(Chosen&& chosen);

  mutable std::mutex mutex_;
  Applied applied_;
  std::vector<AskPointer> waiting_;
};

}  // namespace collided::engine::service
