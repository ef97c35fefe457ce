#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/peers/overlap_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Traits = CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>>;
using Tree = CGAL::AABB_tree<Traits>;

Kernel::Point_3 point_of(const Vec3& v) { return {v[0], v[1], v[2]}; }

/// Counts what it is given.
struct Counter {
  using iterator_category = std::output_iterator_tag;
  using value_type = void;
  using difference_type = std::ptrdiff_t;
  using pointer = void;
  using reference = void;
  long* count;
  Counter& operator*() { return *this; }
  Counter& operator++() { return *this; }
  Counter operator++(int) { return *this; }
  template <class Item>
  Counter& operator=(const Item&) {
    ++*count;
    return *this;
  }
};

/// Its tree, with exact predicates.
class Cgal final : public OverlapPeer {
 public:
  explicit Cgal(const TriangleMesh& mesh) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t = mesh.triangle(i);
      triangles_.emplace_back(point_of(t.a), point_of(t.b), point_of(t.c));
    }
    const double start = thread_seconds();
    tree_.rebuild(triangles_.cbegin(), triangles_.cend());
    tree_.build();
    tree_.accelerate_distance_queries();
    build_s = thread_seconds() - start;
  }
  std::string name() const override { return "CGAL exact predicates"; }

  long sphere(const Vec3& center, double radius_m, bool any) override {
    return count(Kernel::Sphere_3(point_of(center), radius_m * radius_m), any);
  }
  long box(const Vec3& center, const Vec3& half_m, bool any) override {
    return count(Kernel::Iso_cuboid_3(point_of(center - half_m), point_of(center + half_m)), any);
  }
  double closest_m(const Vec3& point) override { return std::sqrt(tree_.squared_distance(point_of(point))); }

 private:
  template <class Set>
  long count(const Set& set, bool any) const {
    if (any) return tree_.do_intersect(set) ? 1 : 0;
    long met = 0;
    tree_.all_intersected_primitives(set, Counter{&met});
    return met;
  }

  Triangles triangles_;
  Tree tree_;
};

}  // namespace

std::unique_ptr<OverlapPeer> cgal_peer(const TriangleMesh& mesh) { return std::make_unique<Cgal>(mesh); }

}  // namespace collided::bench
