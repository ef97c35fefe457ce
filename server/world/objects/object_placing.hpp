#pragma once

#include "server/world/objects/contact_search.hpp"

namespace collided::engine {

/// How far any point of the two objects together may be from where their poses have them, as placing_error_m has it: what
/// a distance or depth of the placed ones is off from that of the shapes and poses given.
///
/// triangle  the one that answered of the object with a mesh, or kNoTriangle: then all of it may
/// cost      linear in the primitives, unless they have an index
double placing_error_m(const Placed& a, std::uint32_t a_triangle, const Placed& b, std::uint32_t b_triangle);

/// Of one, looked at from within the box.
double placing_error_m(const Placed& object, std::uint32_t triangle, const Aabb& other);

}  // namespace collided::engine
