#pragma once

#include <string>

#include "server/geometry/mesh.hpp"

namespace collided::bench {
using namespace engine;

/// Vertices and triangles of a Wavefront file whose faces have three corners; an empty mesh if it is not there.
TriangleMesh read_obj(const std::string& path);

}  // namespace collided::bench
