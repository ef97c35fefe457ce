#pragma once

#include <variant>

#include "server/exact_phase/part.hpp"

/// Whether a yes or no of `overlaps` also holds for two parts that are known only up to off_m: the sum of both parts'
/// largest point errors. Above 0, finite.
namespace collided::engine {

/// True if the two share no point, however they are moved within off_m. False means unknown.
///
/// cost  that of one `overlaps`, for spheres, boxes, capsules and half-spaces with anything, and for two triangles
bool surely_apart(const ConvexPart& a, const ConvexPart& b, double off_m);
bool surely_apart(const Triangle& a, const Triangle& b, double off_m);

/// True if the two share a point, however they are moved within off_m. False means unknown.
bool surely_meet(const ConvexPart& a, const ConvexPart& b, double off_m);

}  // namespace collided::engine
