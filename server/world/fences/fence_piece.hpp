#pragma once

#include <cstdint>

#include "server/exact_phase/motion/body_motion.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/object_rows.hpp"
#include "server/world/objects/sweep.hpp"

namespace collided::engine {

/// An object and a fence in a piece of time in which both move straight and rotate evenly.
struct FencePiece {
  std::uint32_t mover = 0;
  std::uint32_t fence = 0;
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  BodyMotion mover_motion;
  BodyMotion fence_motion;

  /// The same with time reversed.
  FencePiece reversed() const {
    FencePiece back = *this;
    back.mover_motion = mover_motion.reversed();
    back.fence_motion = fence_motion.reversed();
    return back;
  }
};

inline bool is_same(const Frame& a, const Frame& b) { return a.position == b.position && a.rotation == b.rotation; }

inline bool is_resting(const BodyMotion& motion) {
  return motion.turn_rad == 0 && motion.from.position == motion.to.position;
}

/// Testing one against another asks nothing of their bounds, and takes no longer than to work these out.
inline bool is_ball_or_box(const ObjectInfo& info) { return lone_box(info) != nullptr || lone_sphere(info); }

/// An object at a frame. A frame between two poses is interpolated: no pose was given for it.
inline Placed placed_at(const ObjectRows& rows, std::uint32_t slot, const Frame& frame, bool with_bounds = true) {
  const ObjectRow& row = rows[slot];
  const bool is_given = frame.position == row.pose.position && is_same(frame, row.frame());
  return {.info = rows.info(slot),
          .frame = frame,
          .bounds = with_bounds ? bounds_of(*rows.info(slot), frame) : Aabb{},
          .pose = is_given ? &row.pose : nullptr};
}

}  // namespace collided::engine
