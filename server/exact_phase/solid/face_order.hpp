#pragma once

#include <span>

#include "server/exact_phase/solid/solid_tree.hpp"

namespace collided::engine {

/// A convex piece of a triangle, cut by a solid's tree.
struct SolidFace {
  std::uint32_t triangle = 0;
  std::span<const Vec3> outline;  // in the triangle's order; corners at cutting planes are rounded
};

/// Shows every piece of the surface, nearest first as seen from the eye: no piece hides an earlier one. The order is
/// exact; only the outlines are rounded.
///
/// tree  built with keeps_faces
/// eye   finite, in the mesh's frame; anywhere
/// show  returns true to continue
/// cost  one comparison per node
/// source  Fuchs, Kedem, Naylor, "On visible surface generation by a priori tree structures", SIGGRAPH 1980
void show_front_to_back(const SolidTree& tree, const Vec3& eye, FunctionRef<bool(const SolidFace&)> show);

}  // namespace collided::engine
