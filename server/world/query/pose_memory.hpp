#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/world/objects/snapshot.hpp"
#include "server/world/query/move_log.hpp"

namespace collided::engine {

class ObjectRows;
class Sources;

/// Limits of the memory of poses.
struct PoseMemoryOptions {
  std::int64_t reach_ns = 0;          // how far back it reaches; 0: off
  std::size_t max_bytes = 512 << 20;  // of poses; beyond this the memory reaches less far back
};

/// Where objects were: gives a snapshot of any recent instant, with each object where its publisher's poses put it.
/// Reaches back no farther than the last change of static geometry, since keeping two versions would take twice the
/// memory.
/// threads  the writer notes each step; any thread may call the rest, and waits at most for one note
class PoseMemory {
 public:
  explicit PoseMemory(const PoseMemoryOptions& options) : options_(options) {}

  bool is_on() const { return options_.reach_ns > 0; }

  /// The changes of a step, before the rows forget them.
  struct Step {
    const ObjectRows& rows;
    const Sources& sources;
    const SceneList& scenes;
    const std::vector<StaleObject>& stale_objects;
    const Snapshot& snapshot;  // the snapshot that this step fills
  };
  /// Remembers a step. Writer only.
  void note(const Step& step);

  /// The instants for which at() has an answer, world time.
  struct Reach {
    std::int64_t from_ns = 0;
    std::int64_t to_ns = 0;
  };
  Reach reach() const;
  /// Bytes of remembered poses.
  std::size_t bytes() const;

  /// The path of one object, within the reach.
  struct RememberedPath {
    /// From one pose to the next; a jump if both have the same time. Between two pieces it rests.
    struct PathPiece {
      std::int64_t from_ns = 0;
      std::int64_t to_ns = 0;
      BodyMotion motion;
    };
    std::int64_t from_ns = 0;  // it existed from then on, at a known place
    std::int64_t to_ns = 0;    // until then
    Frame first;               // frame before the first piece
    std::vector<PathPiece> pieces;
  };
  /// Nothing if the object does not exist now or the memory is off.
  std::optional<RememberedPath> path_of(ObjectId id) const;

  /// The state of every object at that instant; null outside of reach(). Objects that existed then but whose poses are
  /// not known yet appear as stale: somewhere within the largest speed that they ever had. Poses within a motion are
  /// rounded to a few units in the last place of their coordinates.
  /// cost  all objects once, and an index over them
  std::shared_ptr<const Snapshot> at(std::int64_t time_ns) const;

 private:
  /// One object from its definition to its removal.
  struct Life {
    static constexpr std::int64_t kStillThere = std::numeric_limits<std::int64_t>::max();

    std::shared_ptr<const ObjectInfo> info;
    std::int64_t born_ns = 0;
    std::int64_t gone_ns = kStillThere;
    std::uint32_t source = 0;  // source whose time its poses have
    Pose first;                // pose before the first move
    MoveLog moves;
    /// The point of its frame that moves straight after a move's end, as in BodyMotion; before the first entry: its
    /// origin.
    struct Pivot {
      std::int64_t from_ns = 0;
      Vec3 point = Vec3::Zero();
    };
    std::vector<Pivot> pivots;
    double largest_mps = 0;  // largest speed of any move

    const Pose& last() const { return moves.empty() ? first : moves.back().pose; }
    std::int64_t last_ns() const { return moves.empty() ? born_ns : moves.back().to_ns; }
    Vec3 pivot_of(const Move& move) const;
    void note_pivot(std::int64_t to_ns, const Vec3& pivot);
    bool was_there(std::int64_t time_ns) const { return info && born_ns <= time_ns && time_ns < gone_ns; }
  };
  // A source's time, as in Source.
  struct Known {
    bool is_streamed = false;
    std::int64_t gap_ns = 0;
    std::int64_t known_ns = 0;
    std::int64_t streamed_ns = 0;
  };

  void note_object(const Step& step, std::uint32_t slot);
  static BodyMotion motion_to(const Life& life, const Frame& before, const Move& move);
  void add_move(Life& life, const Move& move);
  bool is_over_limit() const { return move_count_ * sizeof(Move) > options_.max_bytes; }
  void forget(Life& life);
  void forget_blocks(Life& life);
  void forget_in_turn();
  void end(Life& life);
  void move_floor();
  Frame frame_at(const Life& life, std::int64_t time_ns) const;
  std::int64_t known_of(const Life& life) const;
  void put(const Life& life, std::uint32_t slot, std::int64_t time_ns, Snapshot& state) const;

  PoseMemoryOptions options_;
  mutable std::mutex mutex_;  // guards all members below
  std::vector<Life> lives_;   // by slot
  std::deque<Life> gone_;     // removed objects, by gone_ns
  SceneList scenes_;
  std::shared_ptr<const std::vector<Aabb>> covers_;
  bool covers_without_places_ = false;
  std::shared_ptr<const PairRules> pair_rules_;
  std::shared_ptr<const ParentOf> parents_;
  std::vector<Known> sources_;
  std::vector<StaleObject> stale_objects_;
  std::uint64_t epoch_ = 0;
  std::uint64_t version_ = 0;
  std::int64_t from_ns_ = 0;
  std::int64_t to_ns_ = 0;
  std::size_t move_count_ = 0;
  std::size_t turn_ = 0;  // the slot that forget_in_turn() examines next
};

}  // namespace collided::engine
