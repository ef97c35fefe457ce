#pragma once

#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// Whether a ball on its straight way certainly never meets another that rests: the distance of a point from a segment
/// in plain double with one bound for all its roundings. False says nothing.
///
/// cost  about 5 ns against 300 for the end of the way and the time of contact; no allocation
bool surely_apart(const MovingSphere& mover, const Sphere& other);

}  // namespace collided::engine::kernel
