#pragma once

#include "server/exact_phase/motion/time_of_contact.hpp"

namespace collided::engine {

/// A shape in translation: at time t in [0, 1] it is `start` moved by t (to - from), unrounded. The pose that a mover
/// reaches is rounded separately, so the shape placed there may differ from the end of this motion by that rounding.
template <class Shape>
struct Translated {
  Shape start;
  Vec3 from;
  Vec3 to;
};

/// Same promises as for the moving sphere: exact, bracketed, never late, never missed.
///
/// source  box: separating axes of the swept box (Eberly, "Dynamic collision detection using oriented bounding boxes",
///         1999), in exact arithmetic; capsule: its segment sweeps a parallelogram, whose distance to the triangle
///         decides
ExactResult first_contact(const Translated<Box>& mover, const Triangle& other, double width, TimeBracket& bracket);
ExactResult first_contact(const Translated<Capsule>& mover, const Triangle& other, double width, TimeBracket& bracket);

}  // namespace collided::engine
