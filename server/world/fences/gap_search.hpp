#pragma once

#include <cstdint>

#include "server/exact_phase/given/given_gap.hpp"
#include "server/exact_phase/motion/body_motion.hpp"
#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/world/groups/object_clearance.hpp"

namespace collided::engine {

/// An object on its way.
struct GapBody {
  const ObjectInfo* info = nullptr;
  BodyMotion motion;
  double reach_m = 0;  // no point of it is farther from the frame's origin; 0 for what never rotates
  double off_m = 0;    // how far it may be from where the ends of the motion put it
};

/// How far a search for the time of a distance goes.
struct GapOptions {
  double width = 1e-9;  // of the bracket, as a fraction of the motion, unless rounding forbids that
  double from = 0;      // where in the motion the search begins
  std::uint32_t most_looks = 1'000;
  std::uint32_t* looks = nullptr;  // grows by those that were taken; null: not counted
};

/// When two objects first come within a distance of each other. Times are fractions of the motion, 0 to 1.
struct GapTime {
  bool yes = false;
  bool undecided = false;     // they may have come within it earlier, or though none was found
  bool is_cut_short = false;  // the search stopped at most_looks
  TimeBracket bracket;  // not within it before low; within it at high, unless it is only undecided: then high is 1
  ObjectClearance at;   // about bracket.high; of objects that touch there, just before
};

/// The first time at which two moving objects are at most that far apart; exactly so far counts. From each look at the
/// two at a time follows how long they surely stay farther apart: by the plane between two convex bodies that only
/// translate, else by the lengths of their paths.
///
/// threads  any
/// source   conservative advancement: Mirtich, Impulse-based Dynamic Simulation, 1996, ch. 2
GapTime first_within(const GapBody& a, const GapBody& b, const GapLimit& limit, const GapOptions& options,
                     WalkCost& cost);

/// The first time at which two moving objects, which are at most that far apart where the search begins, are farther
/// apart; as first_within() with near and far exchanged.
GapTime first_beyond(const GapBody& a, const GapBody& b, const GapLimit& limit, const GapOptions& options,
                     WalkCost& cost);

/// Whether two objects at rest are at most that far apart, as given where their poses are given.
Decision within(const Placed& a, const Placed& b, const GapLimit& limit, WalkCost& cost);

}  // namespace collided::engine
