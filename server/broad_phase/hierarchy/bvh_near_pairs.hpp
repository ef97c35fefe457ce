#pragma once

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"

namespace collided::engine::bvh {

/// Two trees prepared for the walk to their nearest triangles. Lengths are in a's local unit. Positions are measured
/// from b's local origin, along a's axes or along b's.
struct NearPairFrame {
  double origin[3];   // b's local origin in a's local coordinates
  double to_a[3][3];  // b's local coordinates to positions along a's axes
  double to_b[3][3];  // positions along a's axes to those along b's
  double unit_b;      // b's local unit
  double slack;       // bound on a position's error along any axis, including all roundings of the walk
  double edge_slack;  // additional error of corners kept as edges
  double turned;      // squares of distances along b's axes times this are at most the true squares
  double scale;       // local units per metre

  /// A square that no local distance within limit_m exceeds.
  double local_square(double limit_m) const;
};

/// False if coordinates leave the range that doubles can square, so every triangle has to be paired with all of the
/// other's.
bool prepare_near_pairs(const Layout& a, const Layout& b, const Mat3& rotation, const Vec3& position, double slack_m,
                        NearPairFrame& out);

/// The layouts must not be empty.
void walk_near_pairs(const Layout& a, const Layout& b, const NearPairFrame& frame, double limit_m,
                     Bvh::NearPairCandidate candidate, Bvh::Interrupt is_over, WalkCost& cost);

}  // namespace collided::engine::bvh
