#pragma once

#include "server/exact_phase/distance/convex.hpp"

namespace collided::engine::kernel {

/// A point of the difference set {x_a - x_b} of two sets without their balls, and the points it comes from; all
/// relative to the sets' first carriers, so that no digits are lost far from the origin.
struct DifferencePoint {
  Vec3 w;     // offset + a - b
  Vec3 on_a;  // relative to a.carrier[0]
  Vec3 on_b;  // relative to b.carrier[0]
};

/// The farthest difference point along n.
DifferencePoint difference_support(const Vec3& n, const Convex& a, const Convex& b);

/// The proposal of a search in plain double; only `parted` is proved, by kSupportValueError.
struct Proposal {
  DifferencePoint corner[4];
  double weight[4] = {1, 0, 0, 0};
  int count = 0;
  Vec3 nearest = Vec3::Zero();  // point of the difference set nearest to the origin; zero if the corners enclose it
  bool encloses = false;
  bool parted = false;  // `nearest` is the normal of a plane that separates the sets

  /// The points of a and b whose difference is `nearest`, relative to their first carriers.
  Vec3 on_a() const;
  Vec3 on_b() const;
};

/// The goal of a search.
enum class Seek {
  distance,  // the nearest point, as accurate as double allows
  plane,     // any separating plane, with `nearest` as its normal; or any point of the difference set that the balls
             // cover: the search ends at the first of either
};

/// The point of the difference set nearest to the origin. At most kMostSteps steps.
/// source  Gilbert, Johnson, Keerthi, "A Fast Procedure for Computing the Distance Between Complex Objects in
/// Three-Dimensional Space", 1988; nearest points of triangles: Ericson, "Real-Time Collision Detection", 5.1
Proposal nearest_proposal(const Convex& a, const Convex& b, Seek seek);

/// The face of the difference set nearest to the origin, which the set contains.
struct DepthProposal {
  Vec3 normal = Vec3::UnitX();  // unit, outward: from a to b
  // lower bound on the push in every direction: the true difference set contains that ball
  double least_m = 0;
  Vec3 on_a = Vec3::Zero();  // relative to a.carrier[0]
  Vec3 on_b = Vec3::Zero();
};

/// Grows a polytope inside the difference set, starting from the result of nearest_proposal, until its nearest face is
/// within `tolerance_m` of the set's border or there is no more room.
/// source  van den Bergen, "Proximity Queries and Penetration Depth Computation on 3D Game Objects", 2001
DepthProposal depth_proposal(const Convex& a, const Convex& b, const Proposal& start, double tolerance_m);

}  // namespace collided::engine::kernel
