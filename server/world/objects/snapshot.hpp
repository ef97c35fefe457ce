#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/pose.hpp"
#include "server/world/objects/attachments.hpp"
#include "server/world/objects/object_table.hpp"
#include "server/world/objects/pair_rules.hpp"
#include "server/world/objects/scene_list.hpp"

namespace collided::engine {

/// An object whose publisher is lost: its last known position, and its speed then.
struct StaleObject {
  ObjectId id = 0;
  Vec3 position = Vec3::Zero();  // position of its frame
  double reach_m = 0;            // largest distance of a point of the object from there, metres
  double speed_mps = 0;          // between its last two poses
  std::int64_t posed_ns = 0;     // world time of the last pose
};

/// One immutable, consistent state of all objects: what a query sees.
/// Any thread may read it while it holds the lease; no thread waits for another.
struct Snapshot {
  std::uint64_t epoch = 0;
  std::uint64_t version = 0;
  std::int64_t world_time_ns = 0;
  std::int64_t settled_ns = 0;  // the newest instant at which every object's place is known
  SceneList scenes;
  ObjectTable objects;
  std::vector<Pose> poses;             // by slot
  bool has_given_poses = true;         // false: poses were computed, as at an instant between two given ones
  std::vector<Frame> frames;           // by slot, source of the poses; empty if the poses were given
  std::vector<std::int64_t> posed_ns;  // world time of the pose, by slot; 0: never moved
  std::vector<std::uint8_t> stale;     // 1: the publisher is lost, the pose is frozen
  std::vector<StaleObject> stale_objects;
  std::shared_ptr<const std::vector<Aabb>> covers;  // where the loaded geometry is complete; null: everywhere
  bool covers_without_places = false;               // covers is all that this server holds; see doubt_where_not_held()
  std::shared_ptr<const PairRules> pair_rules;      // which pairs may touch; null: only the filters of objects decide
  std::shared_ptr<const ParentOf> parents;          // parents of attached objects; null: none
  bool contacts_truncated = false;                  // there are more contacts than the step could report
  std::shared_ptr<Grid> grid;  // over all bounds(), or over larger ones; shared between snapshots while no object moves
  // How many of ObjectRows' changes of poses and of objects it has, so that a refill copies only later ones.
  std::uint64_t changes_seen = 0;
  std::uint64_t definitions_seen = 0;

  /// The object's frame. Computed from a given pose on each call, in about 10 ns: storing it would take two fifths of a
  /// state's memory.
  Frame frame(std::uint32_t slot) const { return has_given_poses ? frame_of(poses[slot]) : frames[slot]; }
  /// A box that contains every point of the object at its pose; empty for free slots and static parts. Computed on each
  /// call like frames, since queries need it for few objects.
  Aabb bounds(std::uint32_t slot) const;
};

/// Hands snapshots from the one writer to any number of readers without a lock: a ring of states, each with a count of
/// readers. A reader takes a lease; the writer fills a state that no reader holds and makes it the newest.
class SnapshotRing {
 public:
  static constexpr std::uint32_t kStates = 16;

  /// Keeps one state alive. Copying takes another lease.
  class Lease {
   public:
    Lease() = default;
    Lease(const Lease& other);
    Lease(Lease&& other) noexcept : ring_(other.ring_), index_(other.index_) { other.ring_ = nullptr; }
    Lease& operator=(Lease other) noexcept;
    ~Lease();
    const Snapshot& operator*() const { return ring_->states_[index_].snapshot; }
    const Snapshot* operator->() const { return &ring_->states_[index_].snapshot; }
    explicit operator bool() const { return ring_ != nullptr; }

   private:
    friend class SnapshotRing;
    Lease(const SnapshotRing* ring, std::uint32_t index) : ring_(ring), index_(index) {}
    const SnapshotRing* ring_ = nullptr;
    std::uint32_t index_ = 0;
  };

  /// Takes a lease of the newest state. Lock-free; any thread.
  Lease newest() const;

  /// A state that no reader holds and that is not the newest; nullptr while readers hold all others. Writer only.
  Snapshot* writable();
  /// Makes the state from writable() the newest. Writer only.
  void publish();
  /// The newest state, for the writer itself.
  const Snapshot& current() const { return states_[newest_.load(std::memory_order_relaxed)].snapshot; }

 private:
  struct State {
    Snapshot snapshot;
    mutable std::atomic<std::uint32_t> readers{0};
  };
  std::array<State, kStates> states_;
  std::atomic<std::uint32_t> newest_{0};
  std::uint32_t filling_ = 0;
};

}  // namespace collided::engine
