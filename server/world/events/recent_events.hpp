#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "server/world/events/events.hpp"

namespace collided::engine {

/// An event with the data to explain it later, when the world has changed.
struct RecentEvent {
  Event event;
  std::int64_t world_time_ns = 0;  // time of the step that found it
  std::string a;                   // names, since the objects may be gone
  std::string b;

  /// The interval that contains the change, world time.
  std::int64_t low_ns() const;
  std::int64_t high_ns() const;
};

/// The newest events, for questions about an event after it was published.
///
/// memory   at most kMost events, about 350 bytes each
/// threads  one notes; any reads, and waits at most for one note
class RecentEvents {
 public:
  static constexpr std::size_t kMost = 4'096;

  /// Adds an event; its sequence must follow that of the event before.
  void note(const Event& event, std::int64_t world_time_ns, std::string_view a, std::string_view b);

  /// Nothing if no event has had that number yet, or it was forgotten.
  std::optional<RecentEvent> find(std::uint64_t sequence) const;
  /// The newest events of a fence (the second object of a pair), at most `most`, oldest first.
  std::vector<RecentEvent> last_of(ObjectId b, std::size_t most) const;
  /// Sequences of the stored events; 0: none.
  struct SequenceSpan {
    std::uint64_t first = 0;
    std::uint64_t last = 0;
  };
  SequenceSpan span() const;

 private:
  SequenceSpan known() const;
  const RecentEvent& at(std::uint64_t sequence) const { return ring_[sequence % kMost]; }

  mutable std::mutex mutex_;
  std::vector<RecentEvent> ring_;  // ordered by sequence around its end; grows to kMost
  std::uint64_t last_ = 0;
  std::size_t count_ = 0;
};

}  // namespace collided::engine
