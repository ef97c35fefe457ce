// CGAL's AABB tree answers, with exact predicates and constructions in double: peer_cgal PROBLEM ANSWERS ""
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include <cmath>
#include <vector>

#include "tests/studies/report/methods/peer.hpp"

namespace {

using namespace collided::engine;
using namespace collided;
using report::PeerAnswer;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive3 = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive3>>;

Kernel::Point_3 point(const double* q) { return {q[0], q[1], q[2]}; }

PeerAnswer shoot(const Tree& tree, const double* q) {
  const Kernel::Ray_3 ray(point(q), Kernel::Vector_3(q[3], q[4], q[5]));
  const auto hit = tree.first_intersection(ray);
  if (!hit) return {};
  const Kernel::Point_3* at = boost::get<Kernel::Point_3>(&hit->first);
  if (!at) return {1, std::nan("")};
  return {1, std::sqrt(CGAL::squared_distance(point(q), *at))};
}

PeerAnswer nearest(const Tree& tree, const double* q) { return {1, std::sqrt(tree.squared_distance(point(q)))}; }

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const report::PeerProblem problem = report::read_problem(argv[1]);
  Triangles triangles;
  for (std::uint32_t i = 0; i < problem.mesh.triangles.size(); ++i) {
    const Triangle t = problem.mesh.triangle(i);
    triangles.emplace_back(point(t.a.data()), point(t.b.data()), point(t.c.data()));
  }
  Tree tree(triangles.begin(), triangles.end());
  tree.build();
  if (problem.kind == "ray") {
    return report::serve_peer(problem, argv[2], [&](const double* q) { return shoot(tree, q); });
  }
  if (problem.kind == "nearest") {
    tree.accelerate_distance_queries();
    return report::serve_peer(problem, argv[2], [&](const double* q) { return nearest(tree, q); });
  }
  return 3;
}
