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
  Vec3 start = Vec3::Zero();     // of its centre, where it moved in this step
  Vec3 end = Vec3::Zero();
  // With what its placing may round, and by how much its centre and its frame's origin move apart; negative: the object is
  // not one sphere.
  double radius_m = -1;
};

/// When an object moved to its pose, world time; both equal: it jumped there.
struct MotionTimes {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
};
/// A motion begins at the time of the object's last pose, but no earlier than the time up to which its rest is decided.
///
/// source  whose time the object has; null: the server's own
MotionTimes motion_times(const ObjectRow& row, bool is_new, const Source* source);
/// The motion of any object between two frames; for a lone sphere, the translation of its centre.
///
/// pivot  as of BodyMotion; other than zero only without a lone sphere
BodyMotion motion_between(const std::optional<Sphere>& lone_sphere, const Frame& before, const Frame& now,
                          const Vec3& pivot);

/// The motion by which an object got its newest pose.
///
/// source     whose time it has
/// at_end     its bounds at that pose
/// all_along  of what moved in this step, its bounds on the way
MotionSegment segment_of(const ObjectRows& rows, std::uint32_t slot, const Source& source, const Aabb& at_end,
                         const Aabb& all_along);

/// The motion phase of a step: how each object moves from its previous pose to its new one.
/// threads  the writer's only
/// Always: bounds()[slot] contains the object's whole motion where it may be swept, and else its pose at the end.
class StepMotion {
 public:
  explicit StepMotion(const ObjectRows& rows) : rows_(rows) {}

  /// Takes the motions of the rows that moved; tells `apart` how far meshes moved.
  void begin_step(const Sources& sources, SeparationCache& apart);
  /// What moved rests again. floor_ns: no source needs an earlier time.
  void end_step(std::int64_t floor_ns);

  std::span<const Aabb> bounds() const { return bounds_; }
  /// What rows.bounds() gives, which need not be worked out for what rests.
  Aabb pose_bounds(std::uint32_t slot) const { return holds_more(slot) ? rows_.bounds(slot) : bounds_[slot]; }
  /// Prefetches what pose_bounds() reads of what rests. Always inline: the compiler leaves out calls of what only prefetches.
  [[gnu::always_inline]] void prefetch_bounds(std::uint32_t slot) const {
    const auto* bounds = reinterpret_cast<const char*>(bounds_.data() + slot);
    __builtin_prefetch(bounds);
    __builtin_prefetch(bounds + sizeof(Aabb) - 1);
  }
  /// Slots whose bounds changed since the last note_indexed(); may contain one twice.
  const std::vector<std::uint32_t>& changed() const { return changed_; }
  /// The bounds are in the index.
  void note_indexed() { changed_.clear(); }
  /// Motions on common time; empty where every pair is decided at the step's end.
  const MotionHistory& history() const { return history_; }
  /// Its motion or its beginning is not yet decided against every source.
  bool is_open(std::uint32_t slot) const { return open_[slot] != 0; }
  /// Objects that began after the floor; may contain one twice.
  const std::vector<std::uint32_t>& young() const { return young_; }
  bool is_any_open() const { return !young_.empty() || !history_.travelling().empty(); }
  const BallMotion& ball(std::uint32_t slot) const { return slot < balls_.size() ? balls_[slot] : kNoBall; }
  /// It moved to another pose in this step and is not a lone sphere; spheres have a sweep of their own.
  bool is_swept(std::uint32_t slot) const { return swept_[slot] != 0; }
  /// It is swept and its rotation changes.
  bool turns(std::uint32_t slot) const { return (swept_[slot] & kTurns) != 0; }
  /// The motion of a lone sphere; nothing for other objects, new ones and teleported ones.
  std::optional<MovingSphere> sphere_motion(std::uint32_t slot) const;
  /// The motion of any object; for a lone sphere, the translation of its centre.
  BodyMotion body_motion(std::uint32_t slot) const;
  /// An upper bound on how far a point within reach_m moves; 0 where the object did not move.
  double longest_displacement_m(std::uint32_t slot, double reach_m) const;

 private:
  enum Sweep : std::uint8_t { kMoves = 1, kTurns = 2 };
  inline static const BallMotion kNoBall;

  /// Its bounds may hold more than its pose.
  bool holds_more(std::uint32_t slot) const { return rows_.motion(slot) == Motion::moved || is_open(slot); }
  void note_changed(const std::vector<std::uint32_t>& slots);
  void take_motion(std::uint32_t slot, const std::optional<MovingSphere>& path, const Aabb& at_end);
  void set_ball(std::uint32_t slot, const std::optional<MovingSphere>& motion);
  void begin_anew(const Sources& sources);
  void count_motion(std::uint32_t slot, SeparationCache& apart) const;

  const ObjectRows& rows_;
  std::vector<Aabb> bounds_;
  // A compact copy, since pairs of spheres are filtered before anything else of them is read; empty while there is none.
  std::vector<BallMotion> balls_;
  std::vector<std::uint8_t> swept_;  // Sweep; 0: it is not swept
  std::vector<std::uint8_t> open_;
  std::vector<std::uint32_t> changed_;
  std::vector<std::uint32_t> widened_;  // slots whose bounds hold more than their present pose
  std::vector<std::uint32_t> young_;    // objects that began after the floor; may contain one twice
  MotionHistory history_;
};

}  // namespace collided::engine
