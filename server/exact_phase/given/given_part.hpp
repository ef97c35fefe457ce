#pragma once

#include <variant>

#include "server/geometry/pose.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// A part in its own frame and the pose that places it: the numbers that a user gave, before any rounding. By default
/// the part is in world coordinates already. Holds pointers whose targets must outlive it.
struct GivenPart {
  std::variant<std::monostate, const Primitive*, Triangle> own;
  const Pose* pose = nullptr;
  const Frame* frame = nullptr;  // frame_of(*pose); null: computed on demand

  /// Bound on the distance of the part placed in double from the exact one, metres; 0 if its placing rounds nothing.
  ///
  /// far_m  as in placing_error_m
  double placing_error_m(double far_m) const;
};

}  // namespace collided::engine
