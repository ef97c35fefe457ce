#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "server/world/objects/snapshot.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

struct Ask;

/// Keeps the state on which a request of several chunks is answered, from its first chunk until its last is answered.
/// The world's states are a ring, and pinning all of them would stop its writer, so only a few are kept at a time. A
/// request without a state waits for its turn, first come, first served; requests that have begun are finished. A
/// request loses its state only if its own client keeps others waiting.
///
/// threads  any
/// memory   allocated by the constructor
class SnapshotLeases {
 public:
  static constexpr std::size_t kMostStates = 8;  // of SnapshotRing::kStates; workers and the writer need the rest
  static constexpr std::size_t kMostRequests = 1'024;
  static constexpr std::size_t kMostWaiting = 4'096;  // chunks of requests without a state
  static constexpr std::size_t kMostWaitingBytes = std::size_t{64} << 20;
  /// How long a request without a chunk at hand may keep others waiting, in total.
  static constexpr std::int64_t kPatienceNs = 2'000'000'000;
  /// How long a request may be without a chunk at hand while no other waits.
  static constexpr std::int64_t kLongestPauseNs = 30'000'000'000;
  /// A new request joins a state this young rather than wait for one of its own.
  static constexpr std::int64_t kSharedAgeNs = 20'000'000;

  /// A chunk's part in its request: the state that it is answered on. The chunk is done with when this is released.
  class Hold {
   public:
    Hold() = default;
    Hold(Hold&& other) noexcept : book_(std::exchange(other.book_, nullptr)), key_(other.key_), state_(other.state_) {
      other.state_ = {};
    }
    Hold& operator=(Hold other) noexcept {
      std::swap(book_, other.book_);
      std::swap(key_, other.key_);
      std::swap(state_, other.state_);
      return *this;
    }
    ~Hold() { release(); }
    void release();
    /// Whether it has a state; without one the newest will do.
    explicit operator bool() const { return static_cast<bool>(state_); }
    const SnapshotRing::Lease& state() const { return state_; }

   private:
    friend class SnapshotLeases;
    SnapshotLeases* book_ = nullptr;
    std::pair<std::uint64_t, std::uint64_t> key_{};  // client, request
    SnapshotRing::Lease state_;
  };

  explicit SnapshotLeases(const World& world);
  ~SnapshotLeases();

  /// Sets the receiver of chunks that no longer need to wait. Call this before any other use; `ready` is called on any
  /// thread.
  void on_ready(std::function<void(std::unique_ptr<Ask>)> ready) { ready_ = std::move(ready); }

  enum class Taken : std::uint8_t {
    pinned,  // the ask has its state
    waits,   // it was taken, and returns through on_ready
    gone,    // a later chunk whose request is not, or no longer, kept
    full,    // too many requests or waiting chunks: ask again later
  };
  /// Finds the state for a chunk.
  ///
  /// least_version  the oldest state that will do; greater than any version: only the newest
  Taken take(std::unique_ptr<Ask>& ask, std::uint64_t least_version, std::int64_t now_ns);
  /// A hold of the same state for a part of this hold's chunk that is answered separately.
  Hold share(const Hold& hold);
  /// Keeps the state for an ask without a hold: a request of one chunk that is interrupted by others.
  ///
  /// returns  whether it is kept: false if too many are
  bool keep(Ask& ask, const SnapshotRing::Lease& state, std::int64_t now_ns);
  /// Releases states whose clients keep others waiting. Call this regularly.
  void expire(std::int64_t now_ns);
  /// The waiting chunks; their requests are forgotten.
  std::vector<std::unique_ptr<Ask>> take_waiting();
  /// Requests that keep a state or wait for one.
  std::size_t size() const;

 private:
  struct Entry {
    std::pair<std::uint64_t, std::uint64_t> key;
    std::uint32_t chunks_left;  // not finished yet
    std::uint32_t at_hand = 0;  // of these: taken
    std::uint64_t least_version;
    std::int64_t pinned_ns = 0;
    std::int64_t idle_since_ns = 0;    // since when none is at hand
    std::int64_t kept_waiting_ns = 0;  // how long others waited, in total
    SnapshotRing::Lease state = {};    // none: it waits
  };
  using Entries = std::vector<Entry>;

  Entries::iterator find(const std::pair<std::uint64_t, std::uint64_t>& key);
  std::size_t states() const;
  bool has_room_for(std::size_t bytes, std::size_t most_bytes) const;
  SnapshotRing::Lease state_for(std::uint64_t least_version, std::int64_t now_ns) const;
  void hold(Ask& ask, const Entry& entry);
  void done(const std::pair<std::uint64_t, std::uint64_t>& key);
  std::unique_ptr<Ask> next_ready(std::int64_t now_ns);
  void hand_out(std::int64_t now_ns);

  const World& world_;
  std::function<void(std::unique_ptr<Ask>)> ready_;
  mutable std::mutex mutex_;
  Entries entries_;                            // oldest first
  std::vector<std::unique_ptr<Ask>> waiting_;  // oldest first
  std::size_t waiting_bytes_ = 0;
  std::int64_t expired_ns_ = 0;  // the last call of expire()
};

}  // namespace collided::engine::service
