#pragma once

#include <cstdint>
#include <random>

#include "server/geometry/mesh.hpp"

namespace collided::bench {
using namespace engine;

Vec3 on_sphere(std::mt19937_64& random);

/// Buildings of five faces on a square of streets, heights over a decade, on a ground of two triangles.
TriangleMesh city(std::uint32_t blocks, std::mt19937_64& random);

/// Long thin triangles in every direction.
TriangleMesh needles(std::uint32_t count, std::mt19937_64& random);

/// A floor of rooms x rooms rooms with doors between them, furniture of boxes and a lamp of many triangles in each.
TriangleMesh interior(std::uint32_t rooms, std::mt19937_64& random);

/// A ball of radius 1 with bumps of a hundredth and noise of a tenth of a cell, six grids of squares.
TriangleMesh scanned_ball(std::uint32_t triangle_count, std::uint64_t seed);

}  // namespace collided::bench
