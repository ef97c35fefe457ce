#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include "client/draw/drawing/standing_outlines.hpp"
#include "client/view/figures.hpp"
#include "client/view/standing_follower.hpp"
#include "collided/client.hpp"

namespace collided::view {

/// The interface of displays of a running server; a Follower calls it.
class Observer {
 public:
  virtual ~Observer() = default;

  // One thread calls these.
  virtual void objects(const std::shared_ptr<const ShownObjects>& shown) = 0;  // objects or shapes have changed
  virtual void poses(const Poses& poses) = 0;                                  // some objects have moved
  /// recent  the server's activity since the last status
  virtual void status(const ServerStatus& status, const std::optional<Figures>& recent) = 0;
  /// The figures since the server's start, at the same time; nothing if the server did not send them.
  virtual void totals(const ServerStatus&, const std::optional<Figures>&) {}
  /// Standing questions were added or removed, hold other objects, or have another line to the nearest.
  virtual void standing(std::span<const draw::StandingOutline>) {}
  virtual void silent(double seconds) = 0;  // no answer for this long

  /// Another thread calls this, as soon as events come.
  virtual void events(std::span<const Event> events) = 0;
};

/// When a server was last heard. A busy one may publish its status rarely and still answer, or answer nothing for a
/// while and still publish.
class LastHeard {
 public:
  using Time = std::chrono::steady_clock::time_point;
  explicit LastHeard(Time start) : newest_(start) {}
  void note(Time heard) { newest_ = std::max(newest_, heard); }
  /// Seconds of silence; nothing while that is too short.
  std::optional<double> silence_s(Time now) const {
    constexpr std::chrono::milliseconds kSilent{500};
    if (now - newest_ <= kSilent) return std::nullopt;
    return std::chrono::duration<double>(now - newest_).count();
  }

 private:
  Time newest_;
};

/// How often to ask, and when.
struct FollowOptions {
  std::chrono::milliseconds frame{33};
  std::chrono::milliseconds status{500};
  std::chrono::milliseconds standing{200};
  std::function<bool()> is_watched;  // poses are fetched while it returns true; any thread
};

/// Follows a server on behalf of an observer, across restarts and silences, until it is destroyed. It has two threads.
class Follower {
 public:
  /// client, observer  must outlive it
  static Result<std::unique_ptr<Follower>> start(Client& client, Observer& observer, FollowOptions options);
  ~Follower();
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  Follower(Client& client, Watch watch, Observer& observer, FollowOptions options);
  void look();
  void look_at_poses();
  void look_at_objects(const Poses& poses);
  void look_at_status();
  void look_at_standing();
  void listen();

  Client& client_;
  Watch watch_;
  Observer& observer_;
  const FollowOptions options_;
  std::atomic<bool> stopping_{false};

  // Used by the looking thread only.
  std::shared_ptr<const ShownObjects> shown_;
  std::uint64_t reported_version_ = 0;
  std::uint64_t reported_epoch_ = 0;
  Clock::time_point next_objects_;
  Clock::time_point next_status_;
  Clock::time_point next_standing_;
  StandingFollower standing_;
  LastHeard heard_;
  std::optional<Figures> figures_;

  std::thread looking_;
  std::thread listening_;
};

}  // namespace collided::view
