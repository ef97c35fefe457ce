#pragma once

#include "server/geometry/pose.hpp"
#include "server/exact_phase/part.hpp"
#include "tests/oracle/exact_oracle.hpp"

namespace collided::oracle {

/// A shape of one part and where its pose puts it: by the unrounded rotation v -> q v q* / |q|^2.
struct PosedPart {
  const ConvexPart& part;
  const Pose& pose;
};

enum class WideVerdict { apart, meet, unknown };

/// Whether two convex parts share a point, by walking from support point to support point of their difference in 100
/// digits: a plane that parts them, or four points around the origin, say it. Unknown where neither is found in some
/// hundred steps: they touch, or nearly. No half-spaces. Takes no formula from the product.
WideVerdict wide_verdict(const PosedPart& a, const PosedPart& b);

struct WideInterval {
  Wide low;
  Wide high;
};

/// Bounds of the distance of two that are apart, by the same walk: as narrow as it takes to say whether the distance lies
/// in [low, high], or as 400 steps make them.
WideInterval wide_distance(const PosedPart& a, const PosedPart& b, const Wide& low, const Wide& high);

/// How far b must move along n until a plane across n has a behind it and b ahead; negative: that much room is between
/// them. No half-spaces.
Wide wide_push(const PosedPart& a, const PosedPart& b, const Vec3& n);

/// How high the lowest point of a solid is above a half-space; negative: that deep in it.
Wide wide_height(const PosedPart& solid, const PosedPart& half_space);

}  // namespace collided::oracle
