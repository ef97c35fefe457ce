#pragma once

#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

/// Bounds how far the points of both objects together may be from their exact places: how much a distance or depth of
/// the placed objects may differ from that of the given shapes and poses, metres.
///
/// triangle  the one that decided, if the object has a mesh; kNoTriangle: any
/// cost      linear in the primitives, unless they have an index
double placing_error_m(const Placed& a, std::uint32_t a_triangle, const Placed& b, std::uint32_t b_triangle);

/// Bound for one object; the box bounds the other one, which limits the relevant part of a half-space.
double placing_error_m(const Placed& object, std::uint32_t triangle, const Aabb& other);

}  // namespace collided::engine
