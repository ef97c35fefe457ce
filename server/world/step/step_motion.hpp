#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/world/objects/object_rows.hpp"
#include "server/world/objects/sweep.hpp"
#include "server/world/step/motion_history.hpp"
#include "server/world/step/separation_cache.hpp"

namespace collided::engine {

/// An object that is one sphere, between its last two poses, in world coordinates.
struct alignas(64) BallMotion {  // one cache line
  Vec3 start = Vec3::Zero();     // path of its centre, if it moved in this step
  Vec3 end = Vec3::Zero();
  // Includes the rounding of its placing and the difference between the motions of its centre and its frame's origin.
  // Negative: the object is not one sphere.
  double radius_m = -1;
};

/// When an object moved to its pose, world time; both equal: it jumped there.
struct MotionTimes {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
};
/// The begin of a motion is the time of the object's last pose, but no earlier than the time up to which its rest is
/// decided.
///
/// source  whose time the object has; null: the server's own
MotionTimes motion_times(const ObjectRow& row, bool is_new, const Source* source);
/// The motion of any object between two frames; for a lone sphere, the translation of its centre.
///
/// pivot  as in BodyMotion; zero for a lone sphere
BodyMotion motion_between(const std::optional<Sphere>& lone_sphere, const Frame& before, const Frame& now,
                          const Vec3& pivot);

/// The motion by which an object reached its newest pose.
///
/// source     whose time it has
/// at_end     its bounds at that pose
/// all_along  its bounds during the motion, if it moved in this step
MotionSegment segment_of(const ObjectRows& rows, std::uint32_t slot, const Source& source, const Aabb& at_end,
                         const Aabb& all_along);

/// The motion phase of a step: how each object moves from its previous pose to its new one.
/// threads  the writer only
/// Always: bounds()[slot] contains the object's whole motion if it may be swept, else its pose at the end.
class StepMotion {
 public:
  explicit StepMotion(const ObjectRows& rows) : rows_(rows) {}

  /// Takes the motions of the rows that moved; records in `apart` how far meshes moved.
  void begin_step(const Sources& sources, SeparationCache& apart);
  /// Ends all motions. floor_ns: no source needs an earlier time.
  void end_step(std::int64_t floor_ns);

  std::span<const Aabb> bounds() const { return bounds_; }
  /// Same as rows.bounds(), without computing it for objects at rest.
  Aabb pose_bounds(std::uint32_t slot) const { return holds_more(slot) ? rows_.bounds(slot) : bounds_[slot]; }
  /// Prefetches what pose_bounds() reads for objects at rest. Always inline: the compiler drops calls of functions that
  /// only prefetch.
  [[gnu::always_inline]] void prefetch_bounds(std::uint32_t slot) const {
    const auto* bounds = reinterpret_cast<const char*>(bounds_.data() + slot);
    __builtin_prefetch(bounds);
    __builtin_prefetch(bounds + sizeof(Aabb) - 1);
  }
  /// Slots whose bounds changed since the last note_indexed(); may contain a slot twice.
  const std::vector<std::uint32_t>& changed() const { return changed_; }
  /// Marks the bounds as indexed.
  void note_indexed() { changed_.clear(); }
  /// Motions on common time; empty if every pair is decided at the step's end.
  const MotionHistory& history() const { return history_; }
  /// True if its motion or beginning is not yet decided against every source.
  bool is_open(std::uint32_t slot) const { return open_[slot] != 0; }
  /// Objects that began after the floor; may contain one twice.
  const std::vector<std::uint32_t>& young() const { return young_; }
  bool is_any_open() const { return !young_.empty() || !history_.travelling().empty(); }
  const BallMotion& ball(std::uint32_t slot) const { return slot < balls_.size() ? balls_[slot] : kNoBall; }
  /// True if it moved to another pose in this step and is not a lone sphere; spheres have a sweep of their own.
  bool is_swept(std::uint32_t slot) const { return swept_[slot] != 0; }
  /// True if it is swept and rotates.
  bool turns(std::uint32_t slot) const { return (swept_[slot] & kTurns) != 0; }
  /// The motion of a lone sphere; nothing for other objects, new ones and teleported ones.
  std::optional<MovingSphere> sphere_motion(std::uint32_t slot) const;
  /// The motion of any object; for a lone sphere, the translation of its centre.
  BodyMotion body_motion(std::uint32_t slot) const;
  /// An upper bound on how far a point within reach_m moves; 0 if the object did not move.
  double longest_displacement_m(std::uint32_t slot, double reach_m) const;

 private:
  enum Sweep : std::uint8_t { kMoves = 1, kTurns = 2 };
  inline static const BallMotion kNoBall;

  /// True if its bounds may contain more than its pose.
  bool holds_more(std::uint32_t slot) const { return rows_.motion(slot) == Motion::moved || is_open(slot); }
  void note_changed(const std::vector<std::uint32_t>& slots);
  void take_motion(std::uint32_t slot, const std::optional<MovingSphere>& path, const Aabb& at_end);
  void set_ball(std::uint32_t slot, const std::optional<MovingSphere>& motion);
  void begin_anew(const Sources& sources);
  void count_motion(std::uint32_t slot, SeparationCache& apart) const;

  const ObjectRows& rows_;
  std::vector<Aabb> bounds_;
  // A compact copy, since pairs of spheres are filtered before any other data about them is read; empty without
  // spheres.
  std::vector<BallMotion> balls_;
  std::vector<std::uint8_t> swept_;  // Sweep; 0: not swept
  std::vector<std::uint8_t> open_;
  std::vector<std::uint32_t> changed_;
  std::vector<std::uint32_t> widened_;  // slots whose bounds contain more than their present pose
  std::vector<std::uint32_t> young_;    // objects that began after the floor; may contain one twice
  MotionHistory history_;
};

}  // namespace collided::engine
