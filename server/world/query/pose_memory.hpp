#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <mutex>
#include <vector>

#include "server/world/objects/snapshot.hpp"

namespace collided::engine {

class ObjectRows;
class Sources;

struct PoseMemoryOptions {
  std::int64_t reach_ns = 0;           // how far back; 0: nothing is remembered
  std::size_t max_bytes = 512 << 20;   // of poses; with more than that the memory reaches less far back
};

/// Where objects have been: answers about one instant of the last seconds, at which each object is where its publisher's
/// poses put it. It reaches back no farther than the last change of static geometry, of which two would take twice the
/// room. The writer notes each step; any thread may ask, and waits for a note at most.
class PoseMemory {
 public:
  explicit PoseMemory(const PoseMemoryOptions& options) : options_(options) {}

  bool is_on() const { return options_.reach_ns > 0; }

  /// What a step has changed, before the rows forget it. Writer only.
  struct Step {
    const ObjectRows& rows;
    const Sources& sources;
    const std::vector<std::shared_ptr<const StaticScene>>& scenes;
    const std::vector<StaleObject>& stale_objects;
    const Snapshot& snapshot;  // that the step fills
  };
  void note(const Step& step);

  /// The instants that can be asked for, world time.
  struct Reach {
    std::int64_t from_ns = 0;
    std::int64_t to_ns = 0;
  };
  Reach reach() const;
  /// Bytes of remembered poses.
  std::size_t bytes() const;

  /// Every object at that instant. Those that were there then and are not known so far are told as stale ones: they are
  /// somewhere within the largest speed that was seen of them. The poses of ways are rounded to a few units in the last
  /// place of their coordinates. Null outside of reach().
  /// cost  all objects once, and an index over them
  std::shared_ptr<const Snapshot> at(std::int64_t time_ns) const;

 private:
  /// It rested up to from_ns, and went to the pose until to_ns; both equal: it jumped.
  struct Move {
    std::int64_t from_ns = 0;
    std::int64_t to_ns = 0;
    Pose pose;
  };
  /// One object from its definition to its removal.
  struct Life {
    static constexpr std::int64_t kStillThere = std::numeric_limits<std::int64_t>::max();

    std::shared_ptr<const ObjectInfo> info;
    std::int64_t born_ns = 0;
    std::int64_t gone_ns = kStillThere;
    std::uint32_t source = 0;  // whose time it is known by
    Pose first;               // before the first of the moves
    std::vector<Move> moves;  // by to_ns; the first `forgotten` of them are behind the reach
    std::size_t forgotten = 0;
    double largest_mps = 0;

    const Pose& last() const { return moves.empty() ? first : moves.back().pose; }
    std::int64_t last_ns() const { return moves.empty() ? born_ns : moves.back().to_ns; }
    bool was_there(std::int64_t time_ns) const { return info && born_ns <= time_ns && time_ns < gone_ns; }
  };
  struct Known {
    bool is_streamed = false;
    std::int64_t known_ns = 0;
    std::int64_t streamed_ns = 0;
  };

  void note_object(const Step& step, std::uint32_t slot);
  void add_move(Life& life, const Move& move);
  void forget(Life& life);
  void end(Life& life);
  void move_floor();
  Frame frame_at(const Life& life, std::int64_t time_ns) const;
  std::int64_t known_of(const Life& life) const;
  void put(const Life& life, std::uint32_t slot, std::int64_t time_ns, Snapshot& state) const;

  PoseMemoryOptions options_;
  mutable std::mutex mutex_;  // of all below
  std::vector<Life> lives_;   // by slot
  std::deque<Life> gone_;     // by gone_ns
  std::vector<std::shared_ptr<const StaticScene>> scenes_;
  std::shared_ptr<const std::vector<Aabb>> covers_;
  std::vector<Known> sources_;
  std::vector<StaleObject> stale_objects_;
  std::uint64_t epoch_ = 0;
  std::uint64_t version_ = 0;
  std::int64_t from_ns_ = 0;
  std::int64_t to_ns_ = 0;
  std::size_t move_count_ = 0;
};

}  // namespace collided::engine
