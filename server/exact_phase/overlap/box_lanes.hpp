#pragma once

#include <cstdint>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/shapes.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {

/// The bounds of the axis test of two boxes, as separation_filter.cpp and facet_filter.cpp derive them.
struct BoxGapBounds {
  double of_reach = 0;  // of a gap, times the reach and the square of the axes' largest coordinate
  double off_m = 0;     // how far the points of the two are moved in all
  double singular = 0;  // of a box's volume, times the cube of that coordinate
};

/// Those of quickly_overlaps().
inline BoxGapBounds gap_bounds(double off_m) {
  return {.of_reach = kSeparationError, .off_m = off_m, .singular = kSeparationError};
}

/// Two boxes along the 15 axes of BoxPair, four at a time and with its numbers: `no` where one separates by more than
/// its bound, `yes` where none comes within its bound of doing so, and undecided else and out of range. Parallel edges
/// have no common perpendicular of their own and are left out.
///
/// cost  half of one axis at a time; no allocation
Decision overlap_in_lanes(const Box& a, const Box& b, const BoxGapBounds& bounds);

/// Those of the 15 axes, in the order of facet_axes() and a bit each, along which the push that parts the two may be the
/// least: all but those whose depth less its bound is above another one's with its bound.
///
/// error_share  bound of a depth, times |n|, relative to the reach and the square of the axes' largest coordinate
std::uint32_t least_pushes_in_lanes(const Box& a, const Box& b, double error_share);

/// What overlap_in_lanes() says, and where that is `yes` what least_pushes_in_lanes() does.
struct BoxOverlap {
  Decision decision = Decision::undecided;
  std::uint32_t least_pushes = 0;
};

/// Both at once.
///
/// cost  two thirds of both
BoxOverlap overlap_and_pushes_in_lanes(const Box& a, const Box& b, const BoxGapBounds& bounds, double error_share);

/// How two boxes came to where they are; see box_motion_filter.cpp for the bounds.
struct BoxPairMotion {
  const Box& a_at_start;
  const Box& b_at_start;
  Vec3 travel;         // of b's frame against a's
  double slack = 0;    // of all roundings, relative to the reach
  double error_m = 0;  // of both, besides
  double turn_m = 0;   // what turning moves the points of both by, at most
  double bend_m = 0;   // what it bends their ways by
};

/// Whether an axis that separates the two at the end surely does so all the way. False proves nothing.
bool parted_in_lanes(const Box& a, const Box& b, const BoxPairMotion& motion);

}  // namespace collided::engine::kernel
