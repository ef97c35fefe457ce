#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/world/objects/object.hpp"
#include "server/world/objects/snapshot.hpp"
#include "server/world/objects/sources.hpp"
#include "server/world/objects/sweep.hpp"

namespace collided::engine {

/// How an object came to where it is since the last step.
enum class Motion : std::uint8_t { none, moved, placed };  // placed: new or teleported, so there is no way between

/// In posed_ns: the pose came with the definition and takes its time from the step that shows it first.
inline constexpr std::int64_t kPosedAtStep = -1;

/// What of an object changes as it moves, and what every step asks of it: its description lies far away.
struct ObjectRow {
  ObjectId movable = 0;                // who may be moved; 0: nobody
  std::int64_t posed_ns = 0;           // world time of the pose; 0: never moved
  std::int64_t posed_before_ns = 0;    // and of the pose before
  Pose pose;
  Frame frame;
  Frame frame_before;
  Aabb bounds;
  std::optional<Sphere> lone_sphere;   // that the object is, where it is nothing else
  double reach_m = 0;                  // no point is farther from the frame's origin
  bool has_motion = false;                // the last two poses are the ends of a way
  bool is_stale = false;
  std::int64_t born_ns = 0;            // where its definition's pose begins to hold
  std::int64_t said_before_ns = 0;     // of its pose before, however long it rested since
};

/// When a pose holds, and how the object came there.
struct PoseTime {
  std::int64_t time_ns = 0;
  std::int64_t since_ns = 0;  // it rested up to there
};

/// The table of objects: the one place where rows are added, removed, moved and copied. A row's number is the object's
/// slot. Writer's thread only.
/// Always: info(slot) is null exactly where no object is; motion(slot) is none for all that are not in moved().
class ObjectRows {
 public:
  ObjectRows() : table_(std::make_shared<ObjectTable>()) {}

  // Adding and removing.
  /// A place for an object, in which nothing is yet.
  ObjectId take_slot();
  /// The object named by info->id: a part of a scene, or one that has a pose.
  void put(std::shared_ptr<const ObjectInfo> info);
  /// source: whose time it is known by; born_ns: kPosedAtStep, or the instant from which it is there.
  void put(std::shared_ptr<const ObjectInfo> info, const Pose& pose, std::uint32_t source, std::int64_t born_ns);
  /// Its slot is free again after the step that ends its contacts.
  void remove(ObjectId id);

  /// Objects of that source that came since the last step, and whose beginning is not known yet, begin then.
  void begin(std::uint32_t source, std::int64_t time_ns);

  // Moving.
  /// False: no such object, or it does not move.
  bool move(ObjectId id, const Pose& pose, const PoseTime& at, Motion how);
  /// What move() writes of an object, for writing; a hint, so any slot will do.
  void prefetch(std::uint32_t slot) const;
  /// Everything that moves is looked at again: what was there before may touch what came.
  void place_all_movers_again();
  /// Looked at again, wherever it is: what was not known of it may be decided now.
  void look_again(std::uint32_t slot);
  void set_stale(std::uint32_t slot, bool is_stale);

  // A step: what changed is stamped and copied, and then as if it had always been there.
  void stamp_changes(std::uint64_t step, std::int64_t world_time_ns, const Sources& sources);
  /// Only what changed since `to` was last filled: moving 100 of 100,000 objects costs 100 copies.
  void copy_changes(Snapshot& to);
  void end_step();

  std::size_t size() const { return table_->size(); }
  const ObjectRow& operator[](std::uint32_t slot) const { return rows_[slot]; }
  const ObjectTable& table() const { return *table_; }
  const ObjectInfo* info(std::uint32_t slot) const { return (*table_)[slot].get(); }
  const ObjectInfo* find(ObjectId id) const;
  std::optional<ObjectId> find(std::string_view name) const;
  std::size_t name_count() const { return names_.size(); }
  /// Sources::kResting: it does not move.
  std::uint32_t source(std::uint32_t slot) const { return source_[slot]; }
  Motion motion(std::uint32_t slot) const { return motion_[slot]; }
  /// Defined since the last step.
  bool is_new(std::uint32_t slot) const { return (news_[slot] & kDefined) != 0; }
  /// Has a pose since the last step that is not its definition's.
  bool is_posed(std::uint32_t slot) const { return (news_[slot] & kPosed) != 0; }
  bool has_moved(std::uint32_t slot) const { return motion_[slot] != Motion::none; }
  const std::vector<std::uint32_t>& moved() const { return moved_; }
  bool has_lower_id(std::uint32_t slot, std::uint32_t than) const {
    return generations_[slot] != generations_[than] ? generations_[slot] < generations_[than] : slot < than;
  }

 private:
  ObjectTable& table_to_change();
  void mark(std::uint32_t slot, Motion how);

  std::vector<ObjectRow> rows_;
  // Beside the rows, since they are read for all objects.
  std::vector<Motion> motion_;
  enum News : std::uint8_t { kDefined = 1, kPosed = 2 };
  std::vector<std::uint8_t> news_;      // since the last step
  std::vector<std::uint64_t> changed_;  // step of the last change
  std::vector<std::uint32_t> generations_;
  std::vector<std::uint32_t> source_;

  std::shared_ptr<ObjectTable> table_;  // replaced when a definition changes
  std::uint64_t table_version_ = 0;
  bool table_is_shared_ = false;  // a snapshot holds the table: it is copied before the next change
  std::unordered_map<std::string, ObjectId> names_;
  std::vector<std::uint32_t> free_slots_;
  std::vector<std::uint32_t> freed_;  // in this step
  std::vector<std::uint32_t> moved_;  // in this step
  std::uint64_t step_ = 0;
};

}  // namespace collided::engine
