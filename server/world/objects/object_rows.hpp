#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/world/objects/object_table.hpp"
#include "server/world/objects/snapshot.hpp"
#include "server/world/objects/sources.hpp"
#include "server/world/objects/sweep.hpp"
#include "server/world/objects/tag_index.hpp"

namespace collided::engine {

/// How an object reached its pose since the last step.
enum class Motion : std::uint8_t { none, moved, placed };  // placed: new or teleported, so nothing lies between

/// As posed_ns: the pose came with the definition and gets the time of the step that first shows it.
inline constexpr std::int64_t kPosedAtStep = -1;

/// The changing part of an object, which every step reads; its description, which is rarely read, is kept apart.
struct ObjectRow {
  std::int64_t posed_ns = 0;         // world time of the pose; 0: never moved
  std::int64_t posed_before_ns = 0;  // world time of the previous pose
  // Frames are computed from the poses on demand, in about 10 ns: they would take half as much memory again.
  Pose pose;
  Pose pose_before;
  // Radius of the sphere that is the whole object, metres. Negative: another shape, or a sphere with a pivot, whose
  // centre does not move straight.
  double lone_radius_m = -1;
  // Largest distance of a point from the frame's origin, metres; with a pivot, plus twice the pivot's distance, so that
  // it bounds how far a rotation moves a point.
  double reach_m = 0;
  std::uint32_t movable = 0;       // generation of the object that has this row; 0: it cannot be moved
  bool is_centred_sphere = false;  // a lone sphere whose centre is the frame's origin
  bool has_motion = false;         // the object moved from pose_before to pose
  bool is_stale = false;
  bool has_pivot = false;           // it moves as a part of its parent
  std::int64_t born_ns = 0;         // world time from which the pose of its definition holds
  std::int64_t said_before_ns = 0;  // world time given with its previous pose, however long it rested since
  std::int64_t joined_ns = 0;       // world time up to which it was decided when it got another source's time

  Frame frame() const { return frame_of(pose); }
  Frame frame_before() const { return frame_of(pose_before); }
  bool has_rotation_before() const { return pose.rotation.coeffs() == pose_before.rotation.coeffs(); }
  /// The same as frame_before(), starting from the result of frame(): most motions do not rotate.
  Frame frame_before(const Frame& now) const {
    return has_rotation_before() ? Frame{.rotation = now.rotation, .position = pose_before.position} : frame_before();
  }
  bool is_lone_sphere() const { return lone_radius_m >= 0; }
};

/// Where a pose puts a lone sphere's centre; same result as place().
inline Vec3 placed_center(const Pose& pose, const Vec3& center) {
  // The sum has no negative zero, like place()'s.
  return center.isZero(0) ? Vec3(pose.position + Vec3::Zero()) : place(frame_of(pose), center);
}

/// When a pose holds, and when the motion to it began.
struct PoseTime {
  std::int64_t time_ns = 0;
  std::int64_t since_ns = 0;  // the object rested until then
};

/// Slots in the order of their changes, so that a copy takes only the changes that it lacks. Remembers about as many
/// changes as there are slots.
class SlotChanges {
 public:
  void note(std::uint32_t slot, std::size_t slot_count) {
    if (slots_.size() > slot_count) forget();
    slots_.push_back(slot);
  }
  /// Makes every copy take all slots next.
  void forget() {
    forgotten_ += slots_.size();
    slots_ = {};
  }
  std::uint64_t count() const { return forgotten_ + slots_.size(); }
  /// The changes after the first `seen`; nothing if some are forgotten or there are more than `most`.
  std::optional<std::span<const std::uint32_t>> since(std::uint64_t seen, std::size_t most) const {
    if (seen < forgotten_ || count() - seen > most) return std::nullopt;
    return std::span(slots_).subspan(static_cast<std::size_t>(seen - forgotten_));
  }

 private:
  std::vector<std::uint32_t> slots_;
  std::uint64_t forgotten_ = 0;
};

/// The table of objects: the one place where rows are added, removed, moved and copied. A row's number is the object's
/// slot. threads the writer only Always: info(slot) is null exactly if there is no object; motion(slot) is none for
/// every slot not in moved().
class ObjectRows {
 public:
  // Adding and removing.
  /// An id with a slot for a new object; the slot stays empty until put().
  ObjectId take_slot();
  /// Puts the object into the slot of info->id: a part of a scene, or an object with a pose.
  void put(std::shared_ptr<const ObjectInfo> info);
  /// source: whose time its poses have; born_ns: kPosedAtStep, or the instant from which it exists.
  void put(std::shared_ptr<const ObjectInfo> info, const Pose& pose, std::uint32_t source, std::int64_t born_ns);
  /// Removes an object; its slot is free again after the step that ends its contacts, or stays without an object until
  /// free_slot().
  void remove(ObjectId id, bool keeps_slot = false);
  void free_slot(std::uint32_t slot) { freed_.push_back(slot); }
  /// Scenes were added or removed.
  void note_scenes() { table_.note_scenes(); }

  /// Sets this instant as the beginning of the source's objects that were added since the last step without a known
  /// beginning.
  void begin(std::uint32_t source, std::int64_t time_ns);

  // Moving.
  /// False: no such object, or it cannot move.
  bool move(ObjectId id, const Pose& pose, const PoseTime& at, Motion how);
  /// Prefetches what move() writes. Only a hint: any slot is allowed.
  void prefetch(std::uint32_t slot) const;
  /// Makes the next step test every moving object as if newly placed: it may touch what was just added.
  void place_all_movers_again();
  /// Makes the next step test this object although it did not move: a pair in doubt may be decided now.
  void look_again(std::uint32_t slot);
  void set_stale(std::uint32_t slot, bool is_stale);
  /// From now on the object rotates about this point of its frame; zero: about its origin.
  void set_pivot(std::uint32_t slot, const Vec3& pivot);
  /// From now on its poses have another source's time, in which it rested until known_ns. decided_ns: time up to which
  /// its pairs were decided.
  void follow_source(std::uint32_t slot, std::uint32_t source, std::int64_t known_ns, std::int64_t decided_ns);

  // A step: changes are stamped, then copied, then forgotten.
  /// Stamps the changed rows with the step, and gives a time to objects whose definition's pose has none yet.
  void stamp_changes(std::int64_t world_time_ns, const Sources& sources);
  /// Copies only what changed since `to` was last filled: moving 100 of 100,000 objects costs 100 copies.
  void copy_changes(Snapshot& to);
  /// Forgets the changes; slots freed in this step may be used again. Gives back the rows after the last object once
  /// they are a large enough share that the cost per removed object is a few copies.
  void end_step();

  std::size_t size() const { return table_.size(); }
  /// Number of slots, from 0, that have a row: those of all objects and most free ones between them.
  std::size_t row_count() const { return rows_.size(); }
  const ObjectRow& operator[](std::uint32_t slot) const { return rows_[slot]; }
  /// Bounds of the object at its pose; empty for free slots and static parts. Computed on each call: within a step,
  /// StepMotion::pose_bounds() has most of them.
  Aabb bounds(std::uint32_t slot) const;
  const ObjectTable& table() const { return table_; }
  const ObjectInfo* info(std::uint32_t slot) const { return table_[slot].get(); }
  /// The whole object if it is a single sphere.
  std::optional<Sphere> lone_sphere(std::uint32_t slot) const {
    const ObjectRow& row = rows_[slot];
    if (row.is_centred_sphere) return Sphere{Vec3::Zero(), row.lone_radius_m};
    return row.is_lone_sphere() ? engine::lone_sphere(*info(slot)) : std::nullopt;
  }
  const ObjectInfo* find(ObjectId id) const { return table_.find(id); }
  std::optional<ObjectId> find(std::string_view name) const;
  std::size_t name_count() const { return names_.size(); }
  /// Index of the object's source; Sources::kResting if the object does not move.
  std::uint32_t source(std::uint32_t slot) const { return source_[slot]; }
  Motion motion(std::uint32_t slot) const { return motion_[slot]; }
  /// True if the object was defined since the last step.
  bool is_new(std::uint32_t slot) const { return (news_[slot] & kDefined) != 0; }
  /// True if the object got a pose since the last step, besides its definition's.
  bool is_posed(std::uint32_t slot) const { return (news_[slot] & kPosed) != 0; }
  bool has_moved(std::uint32_t slot) const { return motion_[slot] != Motion::none; }
  /// Slots with a change since the last step.
  const std::vector<std::uint32_t>& moved() const { return moved_; }
  /// The point of its frame that moves straight; see BodyMotion.
  Vec3 pivot(std::uint32_t slot) const { return rows_[slot].has_pivot ? pivots_.at(slot) : Vec3::Zero(); }
  /// Id of the object in the slot, without reading its description.
  ObjectId id(std::uint32_t slot) const { return (static_cast<ObjectId>(generations_[slot]) << 32) | slot; }
  /// Orders as ids do: by generation, then slot.
  bool has_lower_id(std::uint32_t slot, std::uint32_t than) const {
    return generations_[slot] != generations_[than] ? generations_[slot] < generations_[than] : slot < than;
  }

 private:
  void set_info(std::uint32_t slot, ObjectTable::Entry info);
  void make_row(std::uint32_t slot);
  void give_rows_back();
  void mark(std::uint32_t slot, Motion how);
  void note_change(std::uint32_t slot) { changes_.note(slot, size()); }
  void take_extent(std::uint32_t slot, const ObjectInfo& info, const Vec3& pivot);

  std::vector<ObjectRow> rows_;
  std::unordered_map<std::uint32_t, Vec3> pivots_;  // by slot, for rows with has_pivot
  // Outside the rows, since a step reads them for all objects.
  std::vector<Motion> motion_;
  enum News : std::uint8_t { kDefined = 1, kPosed = 2 };
  std::vector<std::uint8_t> news_;  // since the last step
  std::vector<std::uint32_t> generations_;
  std::vector<std::uint32_t> source_;

  ObjectTable table_;
  TagIndex names_{7};  // slots by their objects' names, which the table has
  std::vector<std::uint32_t> free_slots_;
  std::vector<std::uint32_t> freed_;  // slots freed in this step
  std::size_t used_rows_ = 0;         // rows after these have no object
  std::vector<std::uint32_t> moved_;  // slots changed in this step
  SlotChanges changes_;
  SlotChanges definitions_;  // changes of the table
};

}  // namespace collided::engine
