#pragma once

#include <functional>
#include <vector>

#include "server/exact_phase/part.hpp"
#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

/// A part of an object at its pose: a triangle with its number in the object's mesh, or a primitive with kNoTriangle.
struct PlacedPart {
  ConvexPart part;
  std::uint32_t triangle = kNoTriangle;
};

/// Visits the pairs of parts that may come within gap_m of each other (0: that may meet), and possibly others. visit
/// returns false to end the walk.
using PartPairVisit = std::function<bool(const PlacedPart& a, const PlacedPart& b)>;
void visit_part_pairs(const Placed& a, const Placed& b, double gap_m, const PartPairVisit& visit, WalkCost& cost);

/// All parts of an object at its pose: primitives, then triangles.
std::vector<PlacedPart> parts_of(const Placed& object);

}  // namespace collided::engine
