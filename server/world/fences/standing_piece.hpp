#pragma once

#include <algorithm>
#include <cstdint>

#include "idl/clocks.hpp"
#include "server/exact_phase/motion/body_motion.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/geometry/guess_tolerance.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/object_rows.hpp"
#include "server/world/step/pair_windows.hpp"

namespace collided::engine {

/// Width of the brackets in a piece of time, as a fraction of it: reported times are whole nanoseconds.
inline double bracket_width(std::int64_t from_ns, std::int64_t to_ns) {
  constexpr double kWidth_s = 1e-9;
  const double length_s =
      static_cast<double>(std::max<std::int64_t>(to_ns - from_ns, 1)) * wire_contract::kNanosecond_s;
  return std::clamp(kWidth_s / length_s, kNarrowestBracket, kWidestBracket);
}

/// Evaluations that one search along a motion may make, and the total of a step after which each search has only the
/// least.
struct LookBudget {
  std::uint32_t most = 0;
  std::uint32_t of_step = 0;
  std::uint32_t least = 0;

  std::uint32_t after(std::uint32_t looks) const { return std::clamp(of_step - std::min(of_step, looks), least, most); }
};

/// An object and a fence in a piece of time in which both move straight and rotate evenly.
struct StandingPiece {
  std::uint32_t mover = 0;
  std::uint32_t fence = 0;
  std::int64_t from_ns = 0;
  std::int64_t to_ns = 0;
  BodyMotion mover_motion;
  BodyMotion fence_motion;

  double seconds() const { return static_cast<double>(to_ns - from_ns) * wire_contract::kNanosecond_s; }
  /// The piece with time reversed.
  StandingPiece reversed() const {
    StandingPiece back = *this;
    back.mover_motion = mover_motion.reversed();
    back.fence_motion = fence_motion.reversed();
    return back;
  }
};

/// When a predicate starts or stops to hold in a piece, as fractions of it, and where the two are nearest then.
struct TurnTime {
  TimeBracket bracket;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
};

inline BracketNs at_once(std::int64_t time_ns) { return {time_ns, time_ns}; }

/// Converts a bracket of time from the reversed piece.
inline TimeBracket reversed(const TimeBracket& bracket) { return {1 - bracket.high, 1 - bracket.low}; }

inline bool is_same(const Frame& a, const Frame& b) { return a.position == b.position && a.rotation == b.rotation; }

inline bool is_resting(const BodyMotion& motion) {
  return motion.turn_rad == 0 && motion.from.position == motion.to.position;
}

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
