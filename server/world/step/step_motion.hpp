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

/// An object that is one sphere, between its last two poses.
struct BallMotion {
  Vec3 start = Vec3::Zero();  // where it moved in this step
  Vec3 end = Vec3::Zero();
  Vec3 displacement = Vec3::Zero();  // of its frame, where it moved in this step
  double radius_m = -1;              // negative: not one sphere
};

/// When an object went to its pose; both equal: it jumped there.
struct MotionTimes {
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
};
/// A way begins where its object's last pose was, at the earliest where it is decided already that it rested.
/// source  whose time the object is known by; null: the server's own
MotionTimes motion_times(const ObjectRow& row, bool is_new, const Source* source);
/// The way of any object; a lone sphere's is that of its centre.
BodyMotion motion_between(const std::optional<Sphere>& lone_sphere, const Frame& before, const Frame& now);

/// The motion phase of a step: how each object goes from its pose before to its pose now. Writer's thread only.
/// Always: bounds()[slot] contains the object's whole way where a sweep may be asked for it, and its end otherwise.
class StepMotion {
 public:
  explicit StepMotion(const ObjectRows& rows) : rows_(rows) {}

  /// Of what moved; counts how far meshes went.
  void begin_step(const Sources& sources, SeparationCache& apart);
  /// What moved rests. floor_ns: nobody asks for what was up to then.
  void end_step(std::int64_t floor_ns);

  std::span<const Aabb> bounds() const { return bounds_; }
  /// On common time; empty where every pair is decided at the step's end.
  const MotionHistory& history() const { return history_; }
  /// Something of its motion or of its beginning is not decided with everybody yet.
  bool is_open(std::uint32_t slot) const { return open_[slot] != 0; }
  const std::vector<std::uint32_t>& young() const { return young_; }
  bool is_any_open() const { return !young_.empty() || !history_.travelling().empty(); }
  const BallMotion& ball(std::uint32_t slot) const { return balls_[slot]; }
  /// It went to another pose in this step, and is not a lone sphere: those are swept by themselves.
  bool is_swept(std::uint32_t slot) const { return swept_[slot] != 0; }
  bool turns(std::uint32_t slot) const;
  /// The way of a lone sphere; nothing for other objects, new ones and teleported ones.
  std::optional<MovingSphere> sphere_motion(std::uint32_t slot) const;
  /// The way of any object; a lone sphere's is that of its centre.
  BodyMotion body_motion(std::uint32_t slot) const;
  /// At most how far a point within reach_m goes; 0 where there is no way.
  double longest_displacement_m(std::uint32_t slot, double reach_m) const;

 private:
  bool needs_sweep(std::uint32_t slot) const;
  void set_ball(std::uint32_t slot, const std::optional<MovingSphere>& motion);
  void remember(std::uint32_t slot, const Source& source);
  void begin_anew(const Sources& sources);
  void count_way(std::uint32_t slot, SeparationCache& apart) const;

  const ObjectRows& rows_;
  std::vector<Aabb> bounds_;
  std::vector<BallMotion> balls_;  // pairs of balls are looked at before anything else of them is
  std::vector<std::uint8_t> swept_;
  std::vector<std::uint8_t> open_;
  std::vector<std::uint32_t> widened_;  // whose bounds hold more than where they are
  std::vector<std::uint32_t> young_;  // began to be after what is decided with everybody; may be twice in it
  MotionHistory history_;
};

}  // namespace collided::engine
