#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <collided/codes.hpp>
#include <collided/geometry.hpp>
#include <collided/subscription.hpp>

/// Contacts as they begin, go on and end.
#pragma GCC visibility push(default)

namespace collided {

namespace client {
class ShardedWatching;
}

using codes::Containment;
using codes::Doubt;
using codes::EndReason;  // none: the reason was missed, or the event is not an `ended`
using EventKind = codes::ContactEventKind;

/// News of a contact between two objects. Metres, world coordinates.
struct Event {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;
  /// Other than none: from the pair's `began` to its `ended` it is not known whether the two touch, and there is no
  /// point, normal or depth. Such a pair is reported as one that touches, which errs on the safe side.
  Doubt doubt = Doubt::none;
  /// The server had more poses than it could apply: newer ones replaced some of one of the two (PublisherReport), which then
  /// went straight between those that were left. The event is one of that way; on the way that was published it may have been
  /// earlier, later or not at all.
  bool poses_merged = false;
  /// Whether one lies wholly within the other, a declared solid, without meeting its surface: after the event, and of
  /// `emerged` before it. Of `began` it is none: `contained` says so next.
  Containment contained = Containment::none;
  bool resync = false;  // inferred from the contact state: after a gap, at a late start, or from a new server
  std::string a;        // names of the two objects
  std::string b;
  std::uint64_t a_id = 0;  // the server's numbers for them
  std::uint64_t b_id = 0;
  std::uint32_t a_triangle = kNoTriangle;  // of the object's mesh, at the point
  std::uint32_t b_triangle = kNoTriangle;
  std::uint64_t epoch = 0;                 // grows with each start of a server
  std::uint64_t sequence = 0;              // number of the event within the epoch
  std::uint64_t episode = 0;               // sequence of the pair's `began`
  std::chrono::nanoseconds world_time{0};  // of the step that found it, since 1970, by the publishers' clocks
  std::chrono::nanoseconds began{0};       // world time at which the episode began
  double bracket_low_s = 0;                // the change happened between these two, in seconds before world_time
  double bracket_high_s = 0;
  Vec3 point = Vec3::Zero();   // on the contact
  Vec3 normal = Vec3::Zero();  // unit, from a to b
  double depth_m = 0;          // moving b this far along the normal separates the two; no shorter motion does
  double depth_error_m = 0;    // |truth - depth_m| at most
  /// The same three with neighbouring bodies counted as one surface, so that a wheel does not feel the inner edges of a
  /// tiled floor: at such an edge they are along the floor's normal, elsewhere equal to those above.
  Vec3 surface_normal = Vec3::Zero();
  double surface_depth_m = 0;
  double surface_depth_error_m = 0;
  /// Of b relative to a at the point, in m/s, from the last two poses of each. An object counts as at rest while it is
  /// new, was just teleported or has been silent. Zero except for `began` and `persisted`.
  Vec3 relative_velocity = Vec3::Zero();
  double velocity_error = 0;  // m/s; |truth - relative_velocity| at most; infinite: not known (recordings before 0.2)
};

/// World time by which an event's change has happened: the end of its bracket. Events do not come in this order, since
/// each pair is decided once both of its publishers have said where their objects are.
inline std::chrono::nanoseconds happened(const Event& event) {
  return event.world_time - std::chrono::nanoseconds(std::llround(event.bracket_high_s * 1e9));
}

/// How long a contact lasted, from when the two first touched to when they were apart. For events of kind `ended`.
inline std::chrono::nanoseconds lasted(const Event& ended) { return happened(ended) - ended.began; }

/// Which events a watch reports.
struct WatchOptions {
  std::string only = {};          // name glob that one of the two names must match; empty: everything
  std::string skip = {};          // name glob that neither name may match; empty: nothing
  bool persisted = false;         // report also, after each step, the contacts that go on
  std::size_t capacity = 65'536;  // of the queue for next(); when it is full the oldest event is dropped and counted
  /// Report from this time on, since 1970. First comes what held then, as `open`, then what has happened since, both
  /// from the server's flight recorder, then what is new. A server without a flight recorder refuses it.
  std::optional<std::chrono::nanoseconds> since = {};
};

/// A subscription to contact events. It reports the events of every pair once each and in order. Where messages were
/// lost or the server was replaced, it compares the contact state with what it has reported and reports the difference,
/// marked `resync`. What holds at the start comes first, as `open`.
///
/// threads  calls from any thread. It has a thread of its own, on which a callback runs; with one, next() never has an
///          event. Destroying it waits for that thread, so the callback must not destroy it.
class Watch : public Subscription<Event> {
 public:
  /// Number of contacts that hold now according to the events reported.
  std::size_t open_contacts() const;
  /// With WatchOptions::since: the time from which on events are reported, which is later than requested where the
  /// flight recorder does not reach back that far. Else 0.
  std::chrono::nanoseconds tells_since() const;

 private:
  friend class Client;
  friend class client::ShardedWatching;
  struct State;
  explicit Watch(std::unique_ptr<State> state);
  State& state() const;
};

}  // namespace collided

#pragma GCC visibility pop
