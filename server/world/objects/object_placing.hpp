#pragma once

#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

/// Bound on how far the two objects' points together may be from where their poses put them exactly: how much a
/// distance or depth of the placed objects may differ from that of the given shapes and poses, metres.
///
/// triangle  the one that decided, of an object with a mesh; kNoTriangle: any of them may
/// cost      linear in the primitives, unless they have an index
double placing_error_m(const Placed& a, std::uint32_t a_triangle, const Placed& b, std::uint32_t b_triangle);

/// The same for one object; the box bounds the other one, which limits the part of a half-space that matters.
double placing_error_m(const Placed& object, std::uint32_t triangle, const Aabb& other);

}  // namespace collided::engine
