#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <vector>

#include "tests/studies/bench/peers/ray_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Traits = CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>>;

Kernel::Point_3 point_of(const Vec3& v) { return {v[0], v[1], v[2]}; }

class Cgal final : public RayPeer {
 public:
  explicit Cgal(const TriangleMesh& mesh) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t = mesh.triangle(i);
      triangles_.emplace_back(point_of(t.a), point_of(t.b), point_of(t.c));
    }
    tree_.rebuild(triangles_.cbegin(), triangles_.cend());
    tree_.build();
  }
  std::string name() const override { return "CGAL exact predicates"; }
  std::uint32_t nearest(const Ray& ray) override {
    const Vec3& d = ray.direction;
    const auto met =
        tree_.first_intersected_primitive(Kernel::Ray_3(point_of(ray.origin), Kernel::Vector_3(d[0], d[1], d[2])));
    return met ? static_cast<std::uint32_t>(*met - triangles_.cbegin()) : 0xffffffffu;
  }

 private:
  Triangles triangles_;
  CGAL::AABB_tree<Traits> tree_;
};

}  // namespace

std::unique_ptr<RayPeer> cgal_ray_peer(const TriangleMesh& mesh) { return std::make_unique<Cgal>(mesh); }

}  // namespace collided::bench
