#pragma once

#include <optional>

#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/world/query/question.hpp"
#include "server/world/solids/solid.hpp"

namespace collided::engine {

/// The hit of a ray that begins inside a solid, not on its surface: at distance 0. Its exit is where the ray first
/// meets the surface, and its normal the outward one there. Nothing if the ray begins elsewhere, or the question's
/// deadline ends the search.
///
/// cost  a comparison of bounds for a ray that begins outside of them; else that of side_of_placed and, in a solid, of
///       a walk along the ray
std::optional<RayHit> hit_from_inside(const Ray& ray, const SolidMesh& solid, const Placed& object, Question& question);

}  // namespace collided::engine
