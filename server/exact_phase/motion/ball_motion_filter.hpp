#pragma once

#include "server/exact_phase/motion/time_of_contact.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

/// True if a moving sphere certainly never meets one at rest: the distance of a point from a segment in plain double,
/// with one bound for all roundings. False proves nothing.
///
/// cost  about 5 ns, against 300 for a test at the end and the time of contact; no allocation
bool surely_apart(const MovingSphere& mover, const Sphere& other);

}  // namespace collided::engine::kernel
