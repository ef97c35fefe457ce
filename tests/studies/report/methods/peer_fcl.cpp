// FCL answers: peer_fcl PROBLEM ANSWERS ""
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/detail/gjk_solver_libccd.h>

#include <cmath>

#include "tests/studies/report/methods/peer.hpp"

namespace {

using namespace collided;
using report::PeerAnswer;

fcl::Vector3d vector(const double* q) { return {q[0], q[1], q[2]}; }

PeerAnswer sphere_triangle(const double* q) {
  static const fcl::detail::GJKSolver_libccd<double> solver;
  const fcl::Sphere<double> sphere(q[3]);
  fcl::Transform3d placed = fcl::Transform3d::Identity();
  placed.translation() = vector(q);
  fcl::Vector3d point;
  double depth = 0;
  fcl::Vector3d normal;
  if (!solver.shapeTriangleIntersect(sphere, placed, vector(q + 4), vector(q + 7), vector(q + 10), &point, &depth,
                                     &normal)) {
    return {};
  }
  // FCL gives this depth a minus sign.
  return {1, std::abs(depth)};
}

fcl::Transform3d placed(const double* q) {
  fcl::Transform3d result = fcl::Transform3d::Identity();
  result.translation() = vector(q);
  for (int column = 0; column < 3; ++column) result.linear().col(column) = vector(q + 3 + 3 * column);
  return result;
}

PeerAnswer box_box(const double* q) {
  const fcl::Box<double> a(2 * vector(q + 12));
  const fcl::Box<double> b(2 * vector(q + 27));
  const fcl::CollisionRequest<double> request(8, true);
  fcl::CollisionResult<double> result;
  if (fcl::collide(&a, placed(q), &b, placed(q + 15), request, result) == 0) return {};
  // The boxes are one pair: its depth is that of the deepest contact.
  double depth = 0;
  for (std::size_t i = 0; i < result.numContacts(); ++i) {
    depth = std::max(depth, result.getContact(i).penetration_depth);
  }
  return {1, depth};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const report::PeerProblem problem = report::read_problem(argv[1]);
  if (problem.kind == "sphere_triangle") return report::serve_peer(problem, argv[2], sphere_triangle);
  if (problem.kind == "box_box") return report::serve_peer(problem, argv[2], box_box);
  return 3;
}
