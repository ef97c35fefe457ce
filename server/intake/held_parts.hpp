#pragma once

#include <cstddef>

#include "server/geometry/aabb.hpp"
#include "server/intake/scene.hpp"

namespace collided::engine {

/// Numbers of parts and objects removed from a scene.
struct LeftOutOfScene {
  std::size_t parts = 0;
  std::size_t objects = 0;
};

/// Removes everything from a scene that does not reach into a box: whole parts, with their triangles and vertices, and
/// objects. Names, and the numbers of triangles within a part, stay. If triangles are removed, so are the saved index
/// and the simpler forms, which were made for all of them.
///
/// is_moving  the scene's objects will take poses, so none of them is removed
/// error      bounds of objects are rounded outward: one too many may stay
LeftOutOfScene leave_out_beyond(const Aabb& box, Scene& scene, bool is_moving);

}  // namespace collided::engine
