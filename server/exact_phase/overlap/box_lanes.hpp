#pragma once

#include <cstdint>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/geometry/shapes.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {

/// The bounds of the axis test of two boxes, as separation_filter.cpp and facet_filter.cpp derive them.
struct BoxGapBounds {
  double of_reach = 0;  // bound of a gap, times the reach and the square of the axes' largest coordinate
  double off_m = 0;     // how far the points of the two together are moved
  double singular = 0;  // bound of a box's volume, times the cube of that coordinate
};

/// The bounds of quickly_overlaps().
inline BoxGapBounds gap_bounds(double off_m) {
  return {.of_reach = kSeparationError, .off_m = off_m, .singular = kSeparationError};
}

/// Tests two boxes along the 15 axes of BoxPair, four at a time and with its numbers: `no` if one separates by more
/// than its bound, `yes` if none comes within its bound of doing so, else undecided, also out of range. Parallel edges
/// have no common perpendicular of their own and are left out.
///
/// cost  half of one axis at a time; no allocation
Decision overlap_in_lanes(const Box& a, const Box& b, const BoxGapBounds& bounds);

/// The axes along which the separating push may be the least, a bit each, in the order of facet_axes(): all of the 15
/// whose depth less its bound is not above another one's plus its bound.
///
/// error_share  bound of a depth, times |n|, relative to the reach and the square of the axes' largest coordinate
std::uint32_t least_pushes_in_lanes(const Box& a, const Box& b, double error_share);

/// The result of overlap_in_lanes(), and if that is `yes` that of least_pushes_in_lanes().
struct BoxOverlap {
  Decision decision = Decision::undecided;
  std::uint32_t least_pushes = 0;
};

/// Computes both at once.
///
/// cost  two thirds of both
BoxOverlap overlap_and_pushes_in_lanes(const Box& a, const Box& b, const BoxGapBounds& bounds, double error_share);

/// The motions by which two boxes reached their places; see box_motion_filter.cpp for the bounds.
struct BoxPairMotion {
  const Box& a_at_start;
  const Box& b_at_start;
  Vec3 travel;         // of b's frame relative to a's
  double slack = 0;    // rounding in total, relative to the reach
  double error_m = 0;  // further error of both
  double turn_m = 0;   // most that rotation moves the points of both
  double bend_m = 0;   // most that rotation bends their paths
};

/// True if an axis that separates the two at the end certainly does so throughout. False proves nothing.
bool parted_in_lanes(const Box& a, const Box& b, const BoxPairMotion& motion);

}  // namespace collided::engine::kernel
