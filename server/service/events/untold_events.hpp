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

  /// Keeps a frame, and lets go of those that are older than kReachNs or more than kMostEvents before.
  void keep(const EventColumns& events, const Stamp& stamp, bool is_of_fences, std::int64_t now_ns);
  /// Calls tell(const UntoldFrame&) with each that is not too old, in order, and forgets all.
  template <class Tell>
  void tell_all(std::int64_t now_ns, Tell&& tell) {
    forget_old(now_ns);
    for (const UntoldFrame& frame : frames_) tell(frame);
    frames_.clear();
    event_count_ = 0;
  }

 private:
  /// Ten times as long as a primary is silent before it is given up.
  static constexpr std::int64_t kReachNs = 10 * wire_contract::kTakeOverNs;
  /// A subscriber remembers as many that it has heard.
  static constexpr std::size_t kMostEvents = wire_contract::kEventTopic.keep_last;

  void forget_old(std::int64_t now_ns);

  std::deque<UntoldFrame> frames_;
  std::size_t event_count_ = 0;
};

}  // namespace collided::engine::service
