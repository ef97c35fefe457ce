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

/// Places a part of its own frame with the exact rotation v -> q v q* / |q|^2 and the exact translation; all
/// coordinates are multiplied by |q|^2 and by `scale`, so that none is a quotient.
///
/// against  the part that it is compared with; if that is a cylinder or a cone, a flat part gets its border
ExactPart exactly_placed(const ConvexPart& own, const Pose& pose, const Dyadic& scale, const ConvexPart& against);

}  // namespace collided::engine
