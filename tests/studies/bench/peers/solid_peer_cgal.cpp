#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Side_of_triangle_mesh.h>
#include <CGAL/Surface_mesh.h>

#include <vector>

#include "tests/studies/bench/peers/solid_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Surface = CGAL::Surface_mesh<Kernel::Point_3>;

Surface surface_of(const TriangleMesh& mesh) {
  Surface surface;
  std::vector<Surface::Vertex_index> vertices;
  for (const Vec3& v : mesh.vertices) vertices.push_back(surface.add_vertex({v[0], v[1], v[2]}));
  for (const TriangleCorners& t : mesh.triangles) surface.add_face(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  return surface;
}

class Cgal final : public SolidPeer {
 public:
  explicit Cgal(const TriangleMesh& mesh) : surface_(surface_of(mesh)), side_(surface_) {}
  std::string name() const override { return "CGAL side of mesh"; }
  SolidSide side(const Vec3& point) override {
    switch (side_({point[0], point[1], point[2]})) {
      case CGAL::ON_BOUNDED_SIDE: return SolidSide::in;
      case CGAL::ON_BOUNDARY: return SolidSide::on;
      default: return SolidSide::out;
    }
  }

 private:
  Surface surface_;
  CGAL::Side_of_triangle_mesh<Surface, Kernel> side_;
};

}  // namespace

std::unique_ptr<SolidPeer> cgal_solid_peer(const TriangleMesh& mesh) { return std::make_unique<Cgal>(mesh); }

}  // namespace collided::bench
