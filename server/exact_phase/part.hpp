#pragma once

#include <variant>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/separation.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// Any part of an object, in world coordinates.
using ConvexPart = std::variant<Primitive, Triangle>;

inline ConvexPart as_part(const Primitive& primitive) { return primitive; }
inline ConvexPart as_part(const Triangle& triangle) { return triangle; }

/// The part's half-space; null if it is another shape.
inline const HalfSpace* half_space_of(const ConvexPart& part) {
  const auto* primitive = std::get_if<Primitive>(&part);
  return primitive == nullptr ? nullptr : std::get_if<HalfSpace>(primitive);
}

/// Same as in overlap.hpp and contact.hpp, for any kinds.
ExactResult overlaps(const ConvexPart& a, const ConvexPart& b);
Contact contact(const ConvexPart& a, const ConvexPart& b);
Aabb bounds_of_part(const ConvexPart& part);

/// The distance of two parts that do not overlap. For two half-spaces: 0 with an infinite bound.
Separation separation(const ConvexPart& a, const ConvexPart& b);

}  // namespace collided::engine
