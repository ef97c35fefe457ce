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

/// Events of contacts: begin, persistence and end.
#pragma GCC visibility push(default)

namespace collided {

namespace client {
class ShardedWatching;
}

using codes::Containment;
using codes::Doubt;
using codes::EndReason;  // none: the reason was missed, or the event is not an `ended`
using EventKind = codes::ContactEventKind;

/// A change of a contact between two objects. Metres, world coordinates.
struct Event {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;
  /// Other than none: it is not known whether the two touch between the pair's `began` and `ended`, and there is no
  /// point, normal or depth. The pair is reported as touching, which errs on the safe side.
  Doubt doubt = Doubt::none;
  /// The server received more poses than it could apply, and newer ones replaced some poses of one of the two
  /// (PublisherReport). That object then moved straight between the remaining poses, and the event refers to this path.
  /// On the published path it may have come earlier, later or not at all.
  bool poses_merged = false;
  /// Whether one lies wholly within the other, a declared solid, without touching its surface. It is the state after
  /// the event, for `emerged` the state before it. For `began` it is none; a `contained` event follows.
  Containment contained = Containment::none;
  bool resync = false;  // inferred from the contact state after a gap, after a late start or from a new server
  std::string a;        // names of the two objects
  std::string b;
  std::uint64_t a_id = 0;  // the server's numbers for them
  std::uint64_t b_id = 0;
  std::uint32_t a_triangle = kNoTriangle;  // of the object's mesh, at the point
  std::uint32_t b_triangle = kNoTriangle;
  std::uint64_t epoch = 0;                 // grows with each start of a server
  std::uint64_t sequence = 0;              // number of the event within the epoch
  std::uint64_t episode = 0;               // sequence of the pair's `began`
  std::chrono::nanoseconds world_time{0};  // of the step that detected it, since 1970, by the publishers' clocks
  std::chrono::nanoseconds began{0};       // world time at which the episode began
  double bracket_low_s = 0;                // the change happened between these two, in seconds before world_time
  double bracket_high_s = 0;
  Vec3 point = Vec3::Zero();   // on the contact
  Vec3 normal = Vec3::Zero();  // unit, from a to b
  double depth_m = 0;          // moving b this far along the normal separates the two; no shorter motion does
  double depth_error_m = 0;    // |truth - depth_m| at most
  /// Normal, depth and error if adjacent bodies count as one surface, so that a wheel does not feel the inner edges of
  /// a tiled floor. At such an edge they follow the floor's normal; elsewhere they equal the three above.
  Vec3 surface_normal = Vec3::Zero();
  double surface_depth_m = 0;
  double surface_depth_error_m = 0;
  /// Velocity of b relative to a at the point, in m/s, from the last two poses of each. An object counts as at rest
  /// while it is new, was just teleported or has been silent. Zero except for `began` and `persisted`.
  Vec3 relative_velocity = Vec3::Zero();
  double velocity_error = 0;  // m/s; |truth - relative_velocity| at most; infinite: not known (recordings before 0.2)
};

/// World time by which an event's change has happened: the end of its bracket. Events do not arrive in this order,
/// since each pair is decided as soon as both of its publishers have reported their objects' poses.
inline std::chrono::nanoseconds happened(const Event& event) {
  return event.world_time - std::chrono::nanoseconds(std::llround(event.bracket_high_s * 1e9));
}

/// Duration of a contact, from the first touch until the two were apart. For events of kind `ended`.
inline std::chrono::nanoseconds lasted(const Event& ended) { return happened(ended) - ended.began; }

/// Which events a watch reports.
struct WatchOptions {
  std::string only = {};          // name glob that one of the two names must match; empty: everything
  std::string skip = {};          // name glob that neither name may match; empty: nothing
  bool persisted = false;         // after each step, also report the contacts that persist
  std::size_t capacity = 65'536;  // of the queue for next(); when it is full the oldest event is dropped and counted
  /// Report events from this time on, since 1970. First come the contacts open at that time, as `open`, then the events
  /// since, both from the server's flight recorder, then new events. A server without a flight recorder refuses it.
  std::optional<std::chrono::nanoseconds> since = {};
};

/// A subscription to contact events. It reports the events of each pair exactly once and in order. After lost messages
/// or a change of the server, it compares the contact state with its earlier reports and reports the difference, marked
/// `resync`. Contacts that exist at the start come first, as `open`.
///
/// threads  calls from any thread. A callback runs on a thread of the watch; with a callback, next() never returns an
///          event. The destructor waits for that thread, so the callback must not destroy the watch.
class Watch : public Subscription<Event> {
 public:
  /// Number of contacts now open, according to the events reported.
  std::size_t open_contacts() const;
  /// With WatchOptions::since: the time from which events are reported, later than requested if the flight recorder
  /// does not reach back that far. Otherwise 0.
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
