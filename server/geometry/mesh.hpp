#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "server/geometry/shapes.hpp"
#include "server/geometry/vector.hpp"

namespace collided::engine {

/// Three numbers of vertices, counter-clockwise seen from outside.
using TriangleCorners = std::array<std::uint32_t, 3>;

/// Triangle number of a hit on a primitive.
inline constexpr std::uint32_t kNoTriangle = 0xffffffff;

/// Indexed triangles. Every corner is a valid vertex number and every vertex is finite.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<TriangleCorners> triangles;

  Triangle triangle(std::uint32_t i) const {
    const TriangleCorners& corner = triangles[i];
    return {vertices[corner[0]], vertices[corner[1]], vertices[corner[2]]};
  }
};

}  // namespace collided::engine
