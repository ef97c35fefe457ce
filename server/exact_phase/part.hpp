#pragma once

#include <variant>

#include "server/exact_phase/arithmetic/decision.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/separation.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// Whatever objects are made of, in world coordinates.
using ConvexPart = std::variant<Primitive, Triangle>;

inline const HalfSpace* half_space_of(const ConvexPart& part) {
  const auto* primitive = std::get_if<Primitive>(&part);
  return primitive == nullptr ? nullptr : std::get_if<HalfSpace>(primitive);
}

/// As in overlap.hpp and contact.hpp, for whatever kinds the two hold.
ExactResult overlaps(const ConvexPart& a, const ConvexPart& b);
Contact contact(const ConvexPart& a, const ConvexPart& b);
Aabb bounds_of_part(const ConvexPart& part);

/// Of two parts that do not overlap. Of two half-spaces nothing is known but 0 and an infinite bound.
Separation separation(const ConvexPart& a, const ConvexPart& b);

}  // namespace collided::engine
