#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// A side of a triangle: 3 * triangle + k is the side from its corner k to the next.
using HalfEdge = std::uint32_t;

inline std::uint32_t triangle_of(HalfEdge half) { return half / 3; }

/// The edges of a mesh, each once, with all its triangles: the basis for finding boundaries, creases, borders of
/// materials and silhouettes (exact_phase/edge_kinds.hpp), holes and inconsistent orientation
/// (intake/mesh/mesh_health.hpp).
///
/// Edges are ordered by their points, uses of one edge by triangle, so the table does not depend on the machine.
struct EdgeTable {
  struct Edge {
    std::uint32_t low = 0;  // its points, low < high
    std::uint32_t high = 0;
    std::uint32_t first_use = 0;
  };
  std::vector<Edge> edges;  // one extra at the end, so that the last edge's uses have an end
  std::vector<HalfEdge> uses;
  std::vector<bool> is_upward;  // by use: whether its triangle runs from low to high

  std::size_t size() const { return edges.empty() ? 0 : edges.size() - 1; }
  std::span<const HalfEdge> uses_of(std::size_t edge) const {
    return std::span(uses).subspan(edges[edge].first_use, edges[edge + 1].first_use - edges[edge].first_use);
  }
  /// True if exactly two triangles have the edge and both run along it in the same direction: one of them is flipped.
  bool is_inconsistent(std::size_t edge) const {
    const std::uint32_t first = edges[edge].first_use;
    return edges[edge + 1].first_use == first + 2 && is_upward[first] == is_upward[first + 1];
  }
};

/// The edges of all triangles but those left out. A side between equal points is not an edge.
///
/// point_of  the point of each vertex, as a vertex number: first_equal_vertices() joins equal coordinates. Empty: each
/// vertex is a point of its own
/// left_out  by triangle; empty: none
/// cost      linear: two passes over the sides, about 90 ns per triangle; 12 bytes per side and 12 per edge
/// limit     1.4e9 triangles, because sides are numbered in 32 bits
EdgeTable edge_table(const TriangleMesh& mesh, std::span<const std::uint32_t> point_of = {},
                     const std::vector<bool>& left_out = {});

}  // namespace collided::engine
