#pragma once

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"

namespace collided::engine::bvh {

/// Two trees prepared for the simultaneous walk: "a" is the larger, "b" the smaller. Positions are measured along a's
/// axes in a's local unit from b's local origin (so that floats resolve the smaller mesh wherever it is in the larger),
/// and along b's axes in b's local coordinates. All slack is on a's side: a box of a grown by it overlaps a box of b on
/// all six axes wherever the exact bodies meet.
struct PairFrame {       // b's local origin in a's local coordinates: the sum of both
  float center_high[3];  // b's local origin in a's local coordinates: the sum of the two
  float center_low[3];
  float to_a[3][3];
  float to_b[3][3];
  float reach;        // a's boxes are clipped to this; b lies well within
  float box_slack_a;  // for boxes
  float box_slack_b;
  float slack_a;  // for triangles near b; grows by grow_a, grow_b times the distance farther out
  float slack_b;
  float grow_a;
  float grow_b;
};

/// Result of prepare_pairs().
enum class PairCase { apart, near, odd };

/// Prepares the walk for p_a = rotation p_b + position, off by at most slack_m on each axis. odd: floats cannot resolve
/// the pair (lengths out of their range, b a speck in a, or a matrix that is not a rotation), so every triangle near
/// b's bounds must be paired with all of b's.
PairCase prepare_pairs(const Layout& a, const Layout& b, const Mat3& rotation, const Vec3& position, double slack_m,
                       PairFrame& out);

/// Calls candidate with (triangle of a, triangle of b), or exchanged if `swapped`.
void walk_pairs(const Layout& a, const Layout& b, const PairFrame& frame, bool swapped, Bvh::PairCandidate candidate,
                Bvh::Interrupt is_over, WalkCost& cost);

}  // namespace collided::engine::bvh
