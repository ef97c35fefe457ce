#pragma once

#include <cstdint>

#include "server/geometry/mesh.hpp"

namespace collided::scenes {
using namespace engine;

/// Height field over [-size/2, size/2]^2 in x and y, cells x cells squares of two triangles: hills in five octaves
/// and a little roughness. Same seed, same bits.
TriangleMesh terrain(std::uint32_t cells, double size_m, std::uint64_t seed);

/// Closed sphere: an icosahedron split `levels` times, 20 * 4^levels triangles.
TriangleMesh icosphere(int levels, double radius_m, const Vec3& center = Vec3::Zero());

/// Twelve triangles.
TriangleMesh box(const Vec3& half_m, const Vec3& center = Vec3::Zero());

/// Triangles without order: corners within `size_m` of centres in the cube [-1, 1]^3.
TriangleMesh scattered(std::uint32_t count, double size_m, std::uint64_t seed);

/// The same, each corner c within a hundredth of corner a: long, thin and askew, so that their boxes are mostly empty.
TriangleMesh slanted(std::uint32_t count, double size_m, std::uint64_t seed);

/// Sizes over six decades, needles, slivers, points, segments and repeated triangles, in [-1, 1]^3.
TriangleMesh degenerate(std::uint32_t count, std::uint64_t seed);

/// The second mesh's triangles after the first's.
void append(TriangleMesh& mesh, const TriangleMesh& more);

}  // namespace collided::scenes
