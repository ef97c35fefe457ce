#pragma once

#include <cstdint>

#include "server/geometry/aabb.hpp"
#include "server/geometry/mesh.hpp"

namespace collided {

/// What `collide check` says about a mesh. Vertices with equal coordinates count as one point in all of it; triangles
/// without area have no edges here.
struct MeshHealth {
  std::uint64_t vertex_count = 0;
  std::uint64_t equal_vertex_count = 0;  // vertices with the coordinates of an earlier one
  std::uint64_t triangle_count = 0;
  std::uint64_t zero_area_count = 0;
  std::uint64_t duplicate_count = 0;  // triangles with the three points of an earlier one
  std::uint64_t edge_count = 0;
  std::uint64_t boundary_edge_count = 0;      // edges of one triangle
  std::uint64_t nonmanifold_edge_count = 0;   // edges of three and more
  std::uint64_t inconsistent_edge_count = 0;  // edges of two triangles that both run along them the same way
  std::uint64_t component_count = 0;          // pieces that hang together over points
  bool is_closed = false;                     // each edge has exactly two triangles, and there is one
  bool is_consistently_oriented = false;      // no edge is run along twice the same way
  Aabb bounds;                                // of the vertices that triangles use
};

/// cost      a few hash look-ups a triangle and a sort of the edges
/// threads   pure
MeshHealth examine(const TriangleMesh& mesh);

/// True when the three points lie on one line or are one: exact.
bool has_zero_area(const Triangle& triangle);

}  // namespace collided
