#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

#include "server/service/events/event_writer.hpp"

namespace collided::engine::service {

/// The newest events of a server that is silent, to be told once it takes the place of the one that speaks: which of them
/// that one still told, only those who listened know. They leave out what they have heard.
///
/// threads  one
class UntoldEvents {
 public:
  struct UntoldFrame {
    EventColumns events;
    Stamp stamp;
    bool is_of_fences = false;
    std::int64_t kept_ns = 0;  // steady clock
  };

  /// Keeps a frame, and lets go of those that are more than kMostEvents before.
  void keep(const EventColumns& events, const Stamp& stamp, bool is_of_fences, std::int64_t now_ns);
  /// Calls tell(const UntoldFrame&) with those that the other one may not have told, in order, and forgets all. Their numbers
  /// follow each other: it begins behind the last frame with an event from before the two found the same.
  template <class Tell>
  void tell_all(const SpokenBefore& before, Tell&& tell) {
    for (std::size_t i = first_after(before.same_from_ns); i < frames_.size(); ++i) {
      if (frames_[i].kept_ns >= before.heard_ns - kReachNs) tell(frames_[i]);
    }
    frames_.clear();
    event_count_ = 0;
  }

 private:
  /// The same step may be told by the one and kept by the other so far apart.
  static constexpr std::int64_t kReachNs = 2'000'000'000;
  /// A subscriber remembers as many that it has heard.
  static constexpr std::size_t kMostEvents = wire_contract::kEventTopic.keep_last;

  std::size_t first_after(std::int64_t same_from_ns) const;

  std::deque<UntoldFrame> frames_;
  std::size_t event_count_ = 0;  // of all frames
};

}  // namespace collided::engine::service
