#pragma once

#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "server/service/questions/ask.hpp"

namespace collided::engine::service {

/// Questions that wait until a publisher's sample has become part of a published state ("read your own writes").
///
/// threads  any; update() after each step, by the world's thread
class WriteBarriers {
 public:
  static constexpr std::size_t kMost = 1'024;
  static constexpr std::int64_t kPatienceNs = 1'000'000'000;

  enum class Outcome : std::uint8_t { passed, parked, full };
  /// Takes the ask where it must wait.
  Outcome pass(AskPointer& ask);

  /// Every publisher with how far its samples are in the newest published state, by publisher.
  using Applied = std::vector<std::pair<std::uint64_t, std::uint64_t>>;
  void update(const Applied& applied);
  /// Asks that may go on, in the order in which they came.
  std::vector<AskPointer> take_ready();
  /// Asks that waited longer than their deadline or kPatienceNs.
  std::vector<AskPointer> take_overdue(std::int64_t now_ns);
  std::vector<AskPointer> take_all();
  /// 0: nothing of it is known.
  std::uint64_t applied(std::uint64_t publisher) const;
  bool empty() const;

 private:
  std::uint64_t applied_locked(std::uint64_t publisher) const;
  bool reached(const wire::Query& query) const;
  template <class Chosen>
  std::vector<AskPointer> take_if(Chosen&& chosen);

  mutable std::mutex mutex_;
  Applied applied_;
  std::vector<AskPointer> waiting_;
};

}  // namespace collided::engine::service
