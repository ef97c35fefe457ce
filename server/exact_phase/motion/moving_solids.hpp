#pragma once

#include "server/exact_phase/motion/time_of_contact.hpp"

namespace collided::engine {

/// A shape in translation: at time t in [0, 1] it is `start` moved by t (to - from), which is not rounded. The pose
/// that a mover reaches is rounded by itself, so the shape placed there may be off from the end of this way by the
/// pose's own rounding.
template <class Shape>
struct Translated {
  Shape start;
  Vec3 from;
  Vec3 to;
};

/// As for the moving sphere: exact, bracketed, never late, never missed.
///
/// source  box: separating axes of the swept box (Eberly, "Dynamic collision detection using oriented bounding boxes",
///         1999), in exact arithmetic; capsule: the segment's way is a parallelogram, near the triangle or not
ExactResult first_contact(const Translated<Box>& mover, const Triangle& other, double width, TimeBracket& bracket);
ExactResult first_contact(const Translated<Capsule>& mover, const Triangle& other, double width, TimeBracket& bracket);

}  // namespace collided::engine
