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

}  // namespace collided::oracle
