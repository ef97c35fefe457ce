#pragma once

#include "server/exact_phase/distance/convex.hpp"

namespace collided::engine::kernel {

/// A point of the difference set {x_a - x_b} of two sets without their balls, and where it comes from; all as seen from
/// the sets' first carriers, so that the place in the world costs no digits.
struct DifferencePoint {
  Vec3 w;     // offset + a - b
  Vec3 on_a;  // from a.carrier[0]
  Vec3 on_b;  // from b.carrier[0]
};

DifferencePoint difference_support(const Vec3& n, const Convex& a, const Convex& b);

/// What a search in plain double proposes; only `parted` is proved, by kSupportValueError.
struct Proposal {
  DifferencePoint corner[4];
  double weight[4] = {1, 0, 0, 0};
  int count = 0;
  Vec3 nearest = Vec3::Zero();  // of the difference set to the origin; zero where the corners enclose it
  bool encloses = false;
  bool parted = false;  // `nearest` is the normal of a plane between the sets

  Vec3 on_a() const;
  Vec3 on_b() const;
};

/// What a search is for.
enum class Seek {
  distance,  // the nearest point, as sharp as double gives it
  plane,     // any plane that has the sets on two sides: `nearest` is its normal as soon as there is one; or any point
             // of the difference set that the balls reach over
};

/// The nearest point of the difference set to the origin. At most kMostSteps steps.
/// source  Gilbert, Johnson, Keerthi, "A Fast Procedure for Computing the Distance Between Complex Objects in
///         Three-Dimensional Space", 1988; nearest points of triangles: Ericson, "Real-Time Collision Detection", 5.1
Proposal nearest_proposal(const Convex& a, const Convex& b, Seek seek);

/// The face of the difference set nearest to the origin, which it contains.
struct DepthProposal {
  Vec3 normal = Vec3::UnitX();  // unit, outward: from a to b
  double least_m = 0;           // no push, in any direction, is less: the true difference set holds that ball
  Vec3 on_a = Vec3::Zero();     // from a.carrier[0]
  Vec3 on_b = Vec3::Zero();
};

/// Grows a polytope inside the difference set, from what nearest_proposal found, until its nearest face is on the
/// set's border to `tolerance_m` or there is no more room.
/// source  van den Bergen, "Proximity Queries and Penetration Depth Computation on 3D Game Objects", 2001
DepthProposal depth_proposal(const Convex& a, const Convex& b, const Proposal& start, double tolerance_m);

}  // namespace collided::engine::kernel
