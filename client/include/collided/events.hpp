#pragma once

#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <collided/geometry.hpp>

/// Contacts as they begin and end.
#pragma GCC visibility push(default)

namespace collided {

enum class EventKind { open, began, persisted, ended };
enum class EndReason {
  none,
  separated,
  removed,
  publisher_lost,
  teleported,
  geometry_changed,
  server_stopping,
  server_restarted,
  decided
};
/// Why it is not known whether two objects touch: the test came out undecided; the way between two poses could not be
/// followed to its end; one of them is where a lost publisher (LostPolicy::freeze) said last.
enum class Doubt { none, numeric, cost_limit, publisher_lost };

struct Event {
  EventKind kind = EventKind::began;
  EndReason reason = EndReason::none;
  /// Else the pair is not known to touch nor to be apart, from its `began` to its `ended`; there is no point, normal or depth.
  Doubt doubt = Doubt::none;
  bool resync = false;  // learnt from the contact state after a gap, a late start or a new server
  std::string a;
  std::string b;
  std::uint64_t a_id = 0;
  std::uint64_t b_id = 0;
  std::uint32_t a_triangle = kNoTriangle;
  std::uint32_t b_triangle = kNoTriangle;
  std::uint64_t epoch = 0;
  std::uint64_t sequence = 0;
  std::uint64_t episode = 0;  // sequence of the pair's `began`
  std::chrono::nanoseconds world_time{0};
  std::chrono::nanoseconds began{0};  // world time at which the episode began
  double bracket_low_s = 0;           // the change happened between these, seconds before world_time
  double bracket_high_s = 0;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // from a to b
  double depth_m = 0;          // moving b so far along the normal parts the two parts; no way is shorter
  double depth_error_m = 0;
  /// The same where neighbouring bodies count as one surface, so that a wheel does not feel the inner edges of a tiled
  /// floor: at such an edge the floor's normal and the depth along it, else equal to normal and depth_m.
  Vec3 surface_normal = Vec3::Zero();
  double surface_depth_m = 0;
  double surface_depth_error_m = 0;
  /// Of b relative to a at the point, m/s, from the last two poses of each; resting are objects that are new, were
  /// teleported or have been silent. Zero but for `began` and `persisted`.
  Vec3 relative_velocity = Vec3::Zero();
  double velocity_error = 0;  // |truth - relative_velocity| <= velocity_error; infinite in recordings of before 0.2
};

/// World time by which the change of an event had happened: the end of its bracket. Others may be told before it that
/// happened later, for each pair waits until both of its publishers are known.
inline std::chrono::nanoseconds happened(const Event& event) {
  return event.world_time - std::chrono::nanoseconds(std::llround(event.bracket_high_s * 1e9));
}

/// From when the two first touched to when they had parted, of an `ended`.
inline std::chrono::nanoseconds lasted(const Event& ended) { return happened(ended) - ended.began; }

struct WatchOptions {
  std::string only = {};  // either name must match; empty: everything
  std::string skip = {};  // neither name may match
  bool persisted = false;
  std::size_t capacity = 65'536;  // of the poll queue; beyond it the oldest are dropped and counted
  /// Since 1970. What held then comes first as `open`, then what has happened since by the server's flight recorder, then what
  /// comes. Refused where the server keeps none.
  std::optional<std::chrono::nanoseconds> since = {};
};

/// Events of every pair, each once and in order; on a gap or a new server only the differences come, marked `resync`.
/// The first events are `open`: what already holds. Destroying it (not from its own callback) ends the watching.
class Watch {
 public:
  ~Watch();
  Watch(Watch&&) noexcept;
  Watch& operator=(Watch&&) noexcept;

  /// The next event; nothing after `wait`.
  std::optional<Event> next(std::chrono::nanoseconds wait);
  std::uint64_t lost() const;  // events dropped because nobody called next()
  std::uint64_t resyncs() const;
  /// False while no status has come for 240 ms.
  bool connected() const;
  /// The server has vouched for what this watch knows: what held when it began has been told as `open`, what comes from now on is
  /// new. False again while something missed is made up for.
  bool in_step() const;
  /// Contacts that hold now by this watch's own account.
  std::size_t open_contacts() const;
  /// With WatchOptions::since: from when on this watch tells events, later than asked for where the flight recorder does not
  /// reach back that far. Else 0.
  std::chrono::nanoseconds tells_since() const;

 private:
  friend class Client;
  struct State;
  explicit Watch(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace collided

#pragma GCC visibility pop
