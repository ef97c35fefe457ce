#pragma once

#include <variant>

#include "server/exact_phase/part.hpp"
#include "server/exact_phase/round_solids/exact_solid.hpp"
#include "server/geometry/pose.hpp"

namespace collided::engine {

/// All points whose product with the normal is at most that of `point`.
struct Ground {
  kernel::Vector<Dyadic> point;
  kernel::Vector<Dyadic> normal;
};

using ExactPart = std::variant<kernel::ExactSolid, Ground>;

/// |q|^2.
Dyadic square_norm(const Quat& q);

/// A part of its own frame where the exact rotation v -> q v q* / |q|^2 and the exact translation put it, all coordinates
/// times |q|^2 and times `scale`, so that none is a quotient.
///
/// against  the part that it is to be compared with: where that is a cylinder or a cone, a flat part gets its border
ExactPart exactly_placed(const ConvexPart& own, const Pose& pose, const Dyadic& scale, const ConvexPart& against);

}  // namespace collided::engine
