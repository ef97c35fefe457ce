#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "tests/studies/bench/peers/mesh_pair_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalTriangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, CgalTriangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Triangle_3 cgal_triangle(const Triangle& t) {
  return {{t.a[0], t.a[1], t.a[2]}, {t.b[0], t.b[1], t.b[2]}, {t.c[0], t.c[1], t.c[2]}};
}

/// Each triangle of the placed mesh asks the other one's tree: exact predicates. The placing is not timed.
class Cgal final : public MeshPairPeer {
 public:
  Cgal(const TriangleMesh& a, const TriangleMesh& b) : b_(b) {
    for (std::uint32_t i = 0; i < a.triangles.size(); ++i) triangles_.push_back(cgal_triangle(a.triangle(i)));
    tree_.rebuild(triangles_.begin(), triangles_.end());
    tree_.build();
  }
  std::string name() const override { return "CGAL"; }
  void move(const Frame& frame) override {
    placed_.clear();
    for (std::uint32_t i = 0; i < b_.triangles.size(); ++i)
      placed_.push_back(cgal_triangle(place(frame, b_.triangle(i))));
  }
  void all_pairs(TrianglePairs& out) override {
    for (std::size_t j = 0; j < placed_.size(); ++j) {
      found_.clear();
      tree_.all_intersected_primitives(placed_[j], std::back_inserter(found_));
      for (const Tree::Primitive_id& id : found_) {
        out.emplace_back(static_cast<std::uint32_t>(id - triangles_.begin()), static_cast<std::uint32_t>(j));
      }
    }
  }
  bool any() override {
    for (const Kernel::Triangle_3& triangle : placed_) {
      if (tree_.do_intersect(triangle)) return true;
    }
    return false;
  }

 private:
  const TriangleMesh& b_;
  CgalTriangles triangles_;
  CgalTriangles placed_;
  Tree tree_;
  std::vector<Tree::Primitive_id> found_;
};

}  // namespace

std::unique_ptr<MeshPairPeer> cgal_pair_peer(const TriangleMesh& a, const TriangleMesh& b) {
  return std::make_unique<Cgal>(a, b);
}

}  // namespace collided::bench
