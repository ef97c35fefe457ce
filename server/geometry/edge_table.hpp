#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// A side of a triangle: 3 * triangle + k for the side from its corner k to the next.
using HalfEdge = std::uint32_t;

inline std::uint32_t triangle_of(HalfEdge half) { return half / 3; }

/// The edges of a mesh, each once with every triangle that has it: the table from which boundaries, creases, borders of
/// materials and silhouettes are told (exact_phase/edge_kinds.hpp), and holes and wrong turns (intake/mesh_health.hpp).
///
/// Edges are ordered by their points, uses of one edge by triangle, so the table does not depend on the machine.
struct EdgeTable {
  struct Edge {
    std::uint32_t low = 0;  // its points: low < high
    std::uint32_t high = 0;
    std::uint32_t first_use = 0;
  };
  std::vector<Edge> edges;  // one more than there are, so that the last one's uses have an end
  std::vector<HalfEdge> uses;
  std::vector<bool> is_upward;  // of each use: whether its triangle runs from low to high

  std::size_t size() const { return edges.empty() ? 0 : edges.size() - 1; }
  std::span<const HalfEdge> uses_of(std::size_t edge) const {
    return std::span(uses).subspan(edges[edge].first_use, edges[edge + 1].first_use - edges[edge].first_use);
  }
  /// Two triangles have the edge, and both run along it the same way: one of them is turned over.
  bool is_inconsistent(std::size_t edge) const {
    const std::uint32_t first = edges[edge].first_use;
    return edges[edge + 1].first_use == first + 2 && is_upward[first] == is_upward[first + 1];
  }
};

/// The edges of all triangles but those left out. Sides whose ends are one point are no edges.
///
/// point_of  of each vertex its point, a vertex number: first_equal_vertices() joins equal coordinates. Empty: each
///           vertex is a point of its own
/// left_out  of each triangle; empty: none is
/// cost      linear: two passes over the sides, about 90 ns a triangle; 12 bytes a side and 12 an edge
/// limit     1.4e9 triangles, so that sides are numbered in 32 bits
EdgeTable edge_table(const TriangleMesh& mesh, std::span<const std::uint32_t> point_of = {},
                     const std::vector<bool>& left_out = {});

}  // namespace collided::engine
