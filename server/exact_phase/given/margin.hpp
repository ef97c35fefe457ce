#pragma once

#include <variant>

#include "server/exact_phase/part.hpp"

/// Whether a yes or no of `overlaps` also holds for two parts that are known only up to off_m: the larger of the
/// distances by which points of the two may be off, summed over both. Above 0, finite.
namespace collided::engine {

/// No matter how the two are moved within off_m, they share no point. False where they may.
///
/// cost  that of one `overlaps`, for spheres, boxes, capsules and half-spaces with anything, and for two triangles
bool surely_apart(const ConvexPart& a, const ConvexPart& b, double off_m);
bool surely_apart(const Triangle& a, const Triangle& b, double off_m);

/// No matter how the two are moved within off_m, they share a point. False where they may not.
bool surely_meet(const ConvexPart& a, const ConvexPart& b, double off_m);

}  // namespace collided::engine
