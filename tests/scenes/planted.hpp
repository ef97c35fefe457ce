#pragma once

#include <cstdint>
#include <random>
#include <set>
#include <utility>

#include "server/geometry/mesh.hpp"

namespace collided::scenes {
using namespace engine;

/// What was done to a clean mesh, by the numbers that a report should give.
struct Planted {
  TriangleMesh mesh;
  std::set<std::uint32_t> t_vertices;       // points
  std::set<std::uint32_t> cracks_at_edges;  // points beside an edge
  std::set<std::pair<std::uint32_t, std::uint32_t>> cracks_at_points;
  std::set<std::uint32_t> flipped;  // triangles
  std::set<std::uint32_t> duplicates;
  std::set<std::uint32_t> without_area;
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges_of_many;  // points, lower first
};

/// Defects of every kind, `count` of each, at random places of a closed mesh, no two within a ring of triangles.
/// crack_m   cracks are up to that wide
Planted plant(TriangleMesh mesh, std::uint32_t count, double crack_m, std::mt19937_64& random);

/// A sphere whose vertices lie on no grid: 20 * 4^levels triangles, closed.
TriangleMesh rough_sphere(int levels, std::mt19937_64& random);

}  // namespace collided::scenes
