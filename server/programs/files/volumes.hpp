#pragma once

#include "server/intake/scene.hpp"

namespace collided::engine::files {

/// Prints the bounding volumes of all of a scene's vertices: size, volume and the time that each took.
void print_volumes(const Scene& scene);

/// Prints the sizes of the scene's mesh as lists, fans, strips and as an indexed mesh.
void print_encodings(const Scene& scene);

}  // namespace collided::engine::files
