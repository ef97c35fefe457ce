#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/world/events/events.hpp"

namespace collided::engine {

/// An event with what it takes to tell of it later, when the world has gone on.
struct RecentEvent {
  Event event;
  std::int64_t world_time_ns = 0;  // of the step that found it
  std::string a;                   // names, of objects that may be gone
  std::string b;

  /// The change came in this stretch, world time.
  std::int64_t low_ns() const;
  std::int64_t high_ns() const;
};

/// The newest events, for whoever asks about one after it was told.
///
/// memory   at most kMost events, some 350 bytes each
/// threads  one notes; any reads, and waits at most for one note
class RecentEvents {
 public:
  static constexpr std::size_t kMost = 4'096;

  /// The event's sequence follows that of the one noted before.
  void note(const Event& event, std::int64_t world_time_ns, std::string_view a, std::string_view b);

  /// Nothing: there was none of that number so far, or it was forgotten.
  std::optional<RecentEvent> find(std::uint64_t sequence) const;
  /// The newest of one pair's second object, at most so many, oldest first: of a fence.
  std::vector<RecentEvent> last_of(ObjectId b, std::size_t most) const;
  /// Sequences of those that it has; 0: none.
  struct SequenceSpan {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
  };
  SequenceSpan span() const;

 private:
  SequenceSpan known() const;
  const RecentEvent& at(std::uint64_t sequence) const { return ring_[sequence % kMost]; }

  mutable std::mutex mutex_;
  std::vector<RecentEvent> ring_;  // by sequence, around its end; grows to kMost
  std::uint64_t last_ = 0;
  std::size_t count_ = 0;
};

}  // namespace collided::engine
