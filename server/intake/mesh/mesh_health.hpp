#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/edge_table.hpp"
#include "server/intake/mesh/seams.hpp"

namespace collided::engine {

/// Findings about a mesh. Throughout, vertices with equal coordinates count as one point, and triangles without area
/// have no edges. Lists are complete and in ascending order of triangles.
struct MeshHealth {
  std::uint64_t vertex_count = 0;
  std::uint64_t equal_vertex_count = 0;  // vertices with the coordinates of an earlier one
  std::uint64_t triangle_count = 0;
  std::uint64_t zero_area_count = 0;
  std::uint64_t duplicate_count = 0;  // triangles with the three points of an earlier one
  std::uint64_t edge_count = 0;
  std::uint64_t boundary_edge_count = 0;      // edges of one triangle
  std::uint64_t nonmanifold_edge_count = 0;   // edges of three triangles or more
  std::uint64_t inconsistent_edge_count = 0;  // edges along which two triangles run in the same direction
  std::uint64_t component_count = 0;          // pieces, connected by points
  std::uint64_t unorientable_count = 0;       // pieces, connected by edges of two triangles, with one side only
  bool is_closed = false;                     // there are edges, and each has exactly two triangles
  bool is_consistently_oriented = false;      // no two triangles run along an edge in the same direction
  Aabb bounds;                                // of the vertices that triangles use

  std::vector<std::uint32_t> zero_area;       // triangles
  std::vector<std::uint32_t> duplicates;      // triangles
  std::vector<std::uint32_t> flipped;         // triangles oriented against the majority of their piece
  std::vector<HalfEdge> boundary_edges;       // side of the single triangle
  std::vector<HalfEdge> nonmanifold_edges;    // first side
  std::vector<std::uint32_t> pinched_points;  // vertices whose triangles fall into several fans
  std::vector<Seam> seams;                    // T-vertices and cracks
  std::uint64_t seam_unseen_count = 0;        // points not examined for seams; 0 except in soups of long triangles
  SeamReach seam_reach;                       // the distances used in the search for seams
  EdgeTable edges;                            // of the triangles with area, equal points joined

  std::uint64_t t_vertex_count() const;
  std::uint64_t crack_count() const { return seams.size() - t_vertex_count(); }
  /// True if every edge has two triangles at most, and every point one fan.
  bool is_manifold() const { return nonmanifold_edge_count == 0 && pinched_points.empty(); }
};

/// Examines a mesh.
///
/// crack_m   widest crack to look for; 0: kCrackReach times the diagonal
/// cost      about 0.6 us per triangle of a closed mesh, and a further 2 us per edge of one triangle
/// threads   pure
MeshHealth examine(const TriangleMesh& mesh, double crack_m = 0);

/// Whether the three points lie on one line or coincide. Exact.
bool has_zero_area(const Triangle& triangle);

/// A sentence if the size of the bounds suggests another unit than metres ("6009 m across: ..."), else nothing. A guess
/// for the user to read; nothing depends on it.
std::string unit_suspicion(const Aabb& bounds);

}  // namespace collided::engine
