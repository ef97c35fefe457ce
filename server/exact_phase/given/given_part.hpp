#pragma once

#include <variant>

#include "server/geometry/pose.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine {

/// A part in its own frame and the pose that places it: the numbers that a user gave, before anything is rounded. By
/// default the part is in world coordinates already. Holds pointers: what they point to must outlive it.
struct GivenPart {
  std::variant<std::monostate, const Primitive*, Triangle> own;
  const Pose* pose = nullptr;
  const Frame* frame = nullptr;  // frame_of(*pose); null: that is worked out where it is needed

  /// How far the part, placed in double, may be from the numbers given, metres; 0 where its placing rounds nothing.
  ///
  /// far_m  as in placing_error_m
  double placing_error_m(double far_m) const;
};

}  // namespace collided::engine
