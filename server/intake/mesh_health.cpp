#include "server/intake/mesh_health.hpp"

#include <algorithm>
#include <numeric>

#include "server/intake/planar.hpp"
#include "server/intake/weld.hpp"

namespace collided {
namespace {

/// An edge of a triangle: its two points, the smaller first, and which way the triangle runs along it.
struct Edge {
  std::uint64_t points;
  bool is_forward;
};

std::vector<Edge> sorted_edges(const TriangleMesh& mesh, const std::vector<std::uint32_t>& first_equal,
                               const std::vector<bool>& is_flat) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3 && !is_flat[i]; ++k) {
      const std::uint32_t from = first_equal[mesh.triangles[i][k]];
      const std::uint32_t to = first_equal[mesh.triangles[i][(k + 1) % 3]];
      edges.push_back({std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), from < to});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return a.points < b.points; });
  return edges;
}

void count_edges(const std::vector<Edge>& edges, MeshHealth& health) {
  for (std::size_t first = 0; first < edges.size();) {
    std::size_t end = first;
    std::size_t forward_count = 0;
    for (; end < edges.size() && edges[end].points == edges[first].points; ++end) {
      forward_count += edges[end].is_forward ? 1 : 0;
    }
    const std::size_t use_count = end - first;
    ++health.edge_count;
    health.boundary_edge_count += use_count == 1 ? 1 : 0;
    health.nonmanifold_edge_count += use_count > 2 ? 1 : 0;
    health.inconsistent_edge_count += use_count == 2 && forward_count != 1 ? 1 : 0;
    first = end;
  }
}

/// Pieces of points joined by triangles (Galler, Fischer, "An improved equivalence algorithm", 1964).
class Pieces {
 public:
  explicit Pieces(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }

  std::uint32_t find(std::uint32_t point) {
    while (parents_[point] != point) {
      parents_[point] = parents_[parents_[point]];
      point = parents_[point];
    }
    return point;
  }
  void join(std::uint32_t a, std::uint32_t b) { parents_[std::max(find(a), find(b))] = std::min(find(a), find(b)); }

 private:
  std::vector<std::uint32_t> parents_;
};

std::uint64_t count_components(const TriangleMesh& mesh, const std::vector<std::uint32_t>& first_equal) {
  Pieces pieces(mesh.vertices.size());
  std::vector<bool> is_used(mesh.vertices.size(), false);
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) {
      is_used[first_equal[corner]] = true;
      pieces.join(first_equal[corners[0]], first_equal[corner]);
    }
  }
  std::uint64_t count = 0;
  for (std::uint32_t i = 0; i < is_used.size(); ++i) {
    count += is_used[i] && pieces.find(i) == i ? 1 : 0;
  }
  return count;
}

}  // namespace

bool has_zero_area(const Triangle& triangle) {
  for (int u = 0; u < 3; ++u) {
    const int v = (u + 1) % 3;
    if (turn({triangle.a[u], triangle.a[v]}, {triangle.b[u], triangle.b[v]}, {triangle.c[u], triangle.c[v]}) != 0) {
      return false;
    }
  }
  return true;
}

MeshHealth examine(const TriangleMesh& mesh) {
  MeshHealth health;
  health.vertex_count = mesh.vertices.size();
  health.triangle_count = mesh.triangles.size();
  const std::vector<std::uint32_t> first_equal = first_equal_vertices(mesh.vertices);
  for (std::uint32_t i = 0; i < first_equal.size(); ++i) {
    health.equal_vertex_count += first_equal[i] == i ? 0 : 1;
  }
  std::vector<bool> is_flat(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle triangle = mesh.triangle(i);
    is_flat[i] = has_zero_area(triangle);
    health.zero_area_count += is_flat[i] ? 1 : 0;
    health.bounds.extend(triangle.a);
    health.bounds.extend(triangle.b);
    health.bounds.extend(triangle.c);
  }
  health.duplicate_count = count_duplicate_triangles(mesh, first_equal);
  count_edges(sorted_edges(mesh, first_equal, is_flat), health);
  health.component_count = count_components(mesh, first_equal);
  health.is_closed = health.edge_count > 0 && health.boundary_edge_count == 0 && health.nonmanifold_edge_count == 0;
  health.is_consistently_oriented = health.inconsistent_edge_count == 0;
  return health;
}

}  // namespace collided
