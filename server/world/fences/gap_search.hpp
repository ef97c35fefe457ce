#pragma once

#include <cstdint>

#include "server/exact_phase/given/given_gap.hpp"
#include "server/exact_phase/motion/body_motion.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/world/groups/object_clearance.hpp"

namespace collided::engine {

/// An object on its motion.
struct GapBody {
  const ObjectInfo* info = nullptr;
  BodyMotion motion;
  double reach_m = 0;  // largest distance of a point from the frame's origin; 0 if it never rotates
  double off_m = 0;    // bound on its distance from where the ends of the motion put it
};

/// Limits of a search for the time of a distance.
struct GapOptions {
  double width = 1e-9;  // width of the bracket, as a fraction of the motion, unless rounding forbids it
  double from = 0;      // where in the motion the search begins
  std::uint32_t most_looks = 1'000;
  std::uint32_t* looks = nullptr;  // grows by the number of evaluations; null: not counted
};

/// When two objects first come within a distance of each other. Times are fractions of the motion, 0 to 1.
struct GapTime {
  bool yes = false;
  bool undecided = false;     // they may have come within it earlier, or at all if none was found
  bool is_cut_short = false;  // the search stopped at most_looks
  TimeBracket bracket;        // not within it before low; within it at high. If only undecided, high is 1
  ObjectClearance at;         // near bracket.high; for objects that touch there, just before
};

/// The first time at which two moving objects are at most that far apart, equality included. Each evaluation gives a
/// time for which they certainly stay farther apart: by the plane between two convex bodies that only translate, else
/// by the lengths of their paths.
///
/// threads  any
/// source   conservative advancement: Mirtich, Impulse-based Dynamic Simulation, 1996, ch. 2
GapTime first_within(const GapBody& a, const GapBody& b, const GapLimit& limit, const GapOptions& options,
                     WalkCost& cost);

/// The first time at which two moving objects that start at most that far apart are farther apart: first_within() with
/// near and far exchanged.
GapTime first_beyond(const GapBody& a, const GapBody& b, const GapLimit& limit, const GapOptions& options,
                     WalkCost& cost);

/// Whether two objects at rest are at most that far apart; exact for the given poses if there are any.
Decision within(const Placed& a, const Placed& b, const GapLimit& limit, WalkCost& cost);

}  // namespace collided::engine
