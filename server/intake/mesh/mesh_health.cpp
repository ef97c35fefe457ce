#include "server/intake/mesh/mesh_health.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "server/intake/disjoint_sets.hpp"
#include "server/intake/mesh/winding.hpp"
#include "server/intake/polygons/planar.hpp"
#include "server/intake/weld.hpp"

namespace collided::engine {
namespace {

void look_at_triangles(const TriangleMesh& mesh, MeshHealth& health, std::vector<bool>& is_flat) {
  is_flat.resize(mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle triangle = mesh.triangle(i);
    health.bounds.extend(triangle.a);
    health.bounds.extend(triangle.b);
    health.bounds.extend(triangle.c);
    is_flat[i] = has_zero_area(triangle);
    if (is_flat[i]) health.zero_area.push_back(i);
  }
  health.zero_area_count = health.zero_area.size();
}

void look_at_edges(MeshHealth& health) {
  const EdgeTable& edges = health.edges;
  health.edge_count = edges.size();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto uses = edges.uses_of(i);
    if (uses.size() == 1) health.boundary_edges.push_back(uses[0]);
    if (uses.size() > 2) health.nonmanifold_edges.push_back(uses[0]);
    health.inconsistent_edge_count += edges.is_inconsistent(i) ? 1 : 0;
  }
  std::sort(health.boundary_edges.begin(), health.boundary_edges.end());
  std::sort(health.nonmanifold_edges.begin(), health.nonmanifold_edges.end());
  health.boundary_edge_count = health.boundary_edges.size();
  health.nonmanifold_edge_count = health.nonmanifold_edges.size();
}

std::uint64_t count_components(const TriangleMesh& mesh, const std::vector<std::uint32_t>& point_of) {
  DisjointSets pieces(mesh.vertices.size());
  std::vector<bool> is_used(mesh.vertices.size(), false);
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) {
      is_used[point_of[corner]] = true;
      pieces.join(point_of[corners[0]], point_of[corner]);
    }
  }
  std::uint64_t count = 0;
  for (std::uint32_t i = 0; i < is_used.size(); ++i) { count += is_used[i] && pieces.find(i) == i ? 1 : 0; }
  return count;
}

}  // namespace

std::uint64_t MeshHealth::t_vertex_count() const {
  return static_cast<std::uint64_t>(
      std::count_if(seams.begin(), seams.end(), [](const Seam& seam) { return seam.kind == Seam::Kind::t_vertex; }));
}

bool has_zero_area(const Triangle& triangle) {
  for (int u = 0; u < 3; ++u) {
    const int v = (u + 1) % 3;
    if (turn({triangle.a[u], triangle.a[v]}, {triangle.b[u], triangle.b[v]}, {triangle.c[u], triangle.c[v]}) != 0) {
      return false;
    }
  }
  return true;
}

MeshHealth examine(const TriangleMesh& mesh, double crack_m) {
  MeshHealth health;
  health.vertex_count = mesh.vertices.size();
  health.triangle_count = mesh.triangles.size();
  const std::vector<std::uint32_t> point_of = first_equal_vertices(mesh.vertices);
  for (std::uint32_t i = 0; i < point_of.size(); ++i) { health.equal_vertex_count += point_of[i] == i ? 0 : 1; }
  std::vector<bool> is_flat;
  look_at_triangles(mesh, health, is_flat);
  health.duplicates = duplicate_triangles(mesh, point_of);
  health.duplicate_count = health.duplicates.size();
  health.edges = edge_table(mesh, point_of, is_flat);
  look_at_edges(health);
  health.component_count = count_components(mesh, point_of);
  Orientation orientation = orientation_of(mesh.triangles.size(), health.edges);
  health.flipped = std::move(orientation.flipped);
  health.unorientable_count = orientation.unorientable_count;
  health.pinched_points = pinched_points(mesh, health.edges, point_of);
  health.is_closed = health.edge_count > 0 && health.boundary_edge_count == 0 && health.nonmanifold_edge_count == 0;
  health.is_consistently_oriented = health.inconsistent_edge_count == 0;
  health.seam_reach = seam_reach(mesh, health.bounds, crack_m);
  Seams seams = find_seams(mesh, health.edges, point_of, health.seam_reach, health.bounds);
  health.seams = std::move(seams.list);
  health.seam_unseen_count = seams.unseen_count;
  return health;
}

std::string unit_suspicion(const Aabb& bounds) {
  if (bounds.empty()) return {};
  const double size_m = (bounds.high - bounds.low).maxCoeff();
  // A mesh far from the origin is assumed to be a survey in metres, which may well be large.
  const bool is_survey = bounds.low.cwiseMax(-bounds.high).maxCoeff() > 10 * size_m;
  constexpr double kLarge_m = 1000;
  constexpr double kSmall_m = 0.001;
  if (size_m >= kLarge_m && !is_survey) {
    return fmt::format("{:.4g} m across: if the file is in millimetres, it is {:.4g} m (--unit mm)", size_m,
                       size_m / 1000);
  }
  if (size_m > 0 && size_m <= kSmall_m) {
    return fmt::format("{:.4g} m across: if a unit of the file is a kilometre, it is {:.4g} m (--unit km)", size_m,
                       size_m * 1000);
  }
  return {};
}

}  // namespace collided::engine
