#include "tests/scenes/planted.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "server/geometry/edge_table.hpp"
#include "tests/scenes/meshes.hpp"

namespace collided::scenes {
using namespace engine;
namespace {

class Planter {
 public:
  Planter(TriangleMesh mesh, double crack_m, std::mt19937_64& random)
      : crack_m_(crack_m),
        random_(random),
        is_taken_(mesh.vertices.size(), false),
        table_(edge_table(mesh)),
        clean_(mesh.triangles) {
    planted_.mesh = std::move(mesh);
    around_.resize(is_taken_.size());
    for (std::size_t i = 0; i < table_.size(); ++i) {
      around_[table_.edges[i].low].push_back(table_.edges[i].high);
      around_[table_.edges[i].high].push_back(table_.edges[i].low);
    }
  }

  void t_vertex() { planted_.t_vertices.insert(split(0)); }
  void crack_at_edge() { planted_.cracks_at_edges.insert(split(width())); }

  /// One triangle gets a corner of its own.
  void crack_at_point() {
    const HalfEdge half = free_place();
    TriangleCorners& corners = mesh().triangles[triangle_of(half)];
    const std::uint32_t old = corners[half % 3];
    corners[half % 3] = add_vertex(mesh().vertices[old] + width() * direction());
    planted_.cracks_at_points.insert({old, corners[half % 3]});
  }

  void flip() {
    const std::uint32_t triangle = triangle_of(free_place());
    std::swap(mesh().triangles[triangle][0], mesh().triangles[triangle][1]);
    planted_.flipped.insert(triangle);
  }

  /// Its three edges are of three triangles then.
  void repeat() {
    TriangleCorners corners = mesh().triangles[triangle_of(free_place())];
    for (std::size_t k = 0; k < 3; ++k) note_many(corners[k], corners[(k + 1) % 3]);
    std::rotate(corners.begin(), corners.begin() + random_() % 3, corners.end());
    planted_.duplicates.insert(add_triangle(corners));
  }

  void add_flat() {
    const TriangleCorners corners = mesh().triangles[triangle_of(free_place())];
    if (random_() % 2 == 0) {
      planted_.without_area.insert(add_triangle({corners[0], corners[1], corners[1]}));
      return;
    }
    // On a line of small whole numbers, far from everything.
    const auto at = static_cast<double>(100 + mesh().triangles.size());
    planted_.without_area.insert(
        add_triangle({add_vertex({at, 1, 2}), add_vertex({at, 2, 4}), add_vertex({at, 4, 8})}));
  }

  /// A fin on an edge.
  void fin() {
    const HalfEdge half = free_place();
    const TriangleCorners corners = mesh().triangles[triangle_of(half)];
    const std::uint32_t from = corners[half % 3];
    const std::uint32_t to = corners[(half % 3 + 1) % 3];
    const Vec3 out = (mesh().vertices[from] + mesh().vertices[to]).normalized();
    const std::uint32_t top = add_vertex(mesh().vertices[from] + (0.3 + 0.1 * uniform(0, 1)) * out);
    add_triangle({to, from, top});
    note_many(from, to);
  }

  Planted take() { return std::move(planted_); }

 private:
  TriangleMesh& mesh() { return planted_.mesh; }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double width() { return crack_m_ * uniform(0.01, 0.9); }
  Vec3 direction() { return Vec3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized(); }

  std::uint32_t add_vertex(const Vec3& point) {
    mesh().vertices.push_back(point);
    return static_cast<std::uint32_t>(mesh().vertices.size()) - 1;
  }
  std::uint32_t add_triangle(const TriangleCorners& corners) {
    mesh().triangles.push_back(corners);
    return static_cast<std::uint32_t>(mesh().triangles.size()) - 1;
  }
  void note_many(std::uint32_t a, std::uint32_t b) { planted_.edges_of_many.insert({std::min(a, b), std::max(a, b)}); }

  /// A side of a triangle of the clean mesh; it and everything around are taken from then on.
  HalfEdge free_place() {
    for (;;) {
      const HalfEdge half = table_.uses[random_() % table_.uses.size()];
      const TriangleCorners& corners = clean_[triangle_of(half)];
      std::set<std::uint32_t> ring(corners.begin(), corners.end());
      for (const std::uint32_t corner : corners) ring.insert(around_[corner].begin(), around_[corner].end());
      if (std::any_of(ring.begin(), ring.end(), [&](std::uint32_t point) { return is_taken_[point]; })) continue;
      for (const std::uint32_t point : ring) is_taken_[point] = true;
      return half;
    }
  }

  /// Cuts one of an edge's two triangles at a point of the edge, moved by so much off it.
  std::uint32_t split(double off_m) {
    const HalfEdge half = free_place();
    const TriangleCorners corners = mesh().triangles[triangle_of(half)];
    const std::uint32_t k = half % 3;
    const std::uint32_t a = corners[k];
    const std::uint32_t b = corners[(k + 1) % 3];
    const std::uint32_t c = corners[(k + 2) % 3];
    const Vec3 along = mesh().vertices[b] - mesh().vertices[a];
    // Across the edge and out of the face, so that the neighbour does not reach it.
    const Vec3 off = along.cross(direction()).normalized() * off_m;
    const std::uint32_t point = add_vertex(mesh().vertices[a] + uniform(0.3, 0.7) * along + off);
    mesh().triangles[triangle_of(half)] = {a, point, c};
    add_triangle({point, b, c});
    return point;
  }

  double crack_m_;
  std::mt19937_64& random_;
  std::vector<bool> is_taken_;  // points of the clean mesh
  EdgeTable table_;             // of the clean mesh
  std::vector<TriangleCorners> clean_;
  std::vector<std::vector<std::uint32_t>> around_;
  Planted planted_;
};

}  // namespace

Planted plant(TriangleMesh mesh, std::uint32_t count, double crack_m, std::mt19937_64& random) {
  Planter planter(std::move(mesh), crack_m, random);
  for (std::uint32_t i = 0; i < count; ++i) {
    planter.t_vertex();
    planter.crack_at_edge();
    planter.crack_at_point();
    planter.flip();
    planter.repeat();
    planter.add_flat();
    planter.fin();
  }
  return planter.take();
}

TriangleMesh rough_sphere(int levels, std::mt19937_64& random) {
  TriangleMesh mesh = icosphere(levels, 1);
  std::uniform_real_distribution<double> stretch(0.97, 1.03);
  for (Vec3& v : mesh.vertices) v = v.cwiseProduct(Vec3(1, 1.1, 0.9)) * stretch(random);
  return mesh;
}

}  // namespace collided::scenes
