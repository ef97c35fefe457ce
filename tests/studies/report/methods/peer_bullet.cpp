// Bullet answers, in the precision that it was built with: peer_bullet_float|peer_bullet_double PROBLEM ANSWERS ""
#include <BulletCollision/CollisionDispatch/SphereTriangleDetector.h>
#include <BulletCollision/CollisionDispatch/btBoxBoxDetector.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btSubSimplexConvexCast.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "tests/studies/report/methods/peer.hpp"

namespace {

using namespace collided::engine;
using namespace collided;
using report::PeerAnswer;

btVector3 vector(const double* q) {
  return {static_cast<btScalar>(q[0]), static_cast<btScalar>(q[1]), static_cast<btScalar>(q[2])};
}

struct Deepest : btDiscreteCollisionDetectorInterface::Result {
  double distance = std::numeric_limits<double>::infinity();
  void setShapeIdentifiersA(int, int) override {}
  void setShapeIdentifiersB(int, int) override {}
  void addContactPoint(const btVector3&, const btVector3&, btScalar depth) override {
    distance = std::min(distance, static_cast<double>(depth));
  }
  PeerAnswer answer() const { return distance <= 0 ? PeerAnswer{1, -distance} : PeerAnswer{}; }
};

class RayScene {
 public:
  explicit RayScene(const TriangleMesh& mesh) {
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Triangle t = mesh.triangle(i);
      soup_.addTriangle(vector(t.a.data()), vector(t.b.data()), vector(t.c.data()));
    }
    shape_ = std::make_unique<btBvhTriangleMeshShape>(&soup_, true);
    object_.setCollisionShape(shape_.get());
    for (const Vec3& v : mesh.vertices) reach_ = std::max(reach_, v.cwiseAbs().maxCoeff());
  }

  /// Bullet's rays have an end: well behind the mesh.
  PeerAnswer shoot(const double* q) {
    const double length = std::sqrt(q[3] * q[3] + q[4] * q[4] + q[5] * q[5]);
    const double origin = std::max({std::abs(q[0]), std::abs(q[1]), std::abs(q[2])});
    const double factor = 4 * (reach_ + origin) / length;
    const double end[3] = {q[0] + factor * q[3], q[1] + factor * q[4], q[2] + factor * q[5]};
    btCollisionWorld::ClosestRayResultCallback nearest(vector(q), vector(end));
    nearest.m_flags = 0;
    const btTransform from(btQuaternion::getIdentity(), vector(q));
    const btTransform to(btQuaternion::getIdentity(), vector(end));
    btCollisionWorld::rayTestSingle(from, to, &object_, shape_.get(), btTransform::getIdentity(), nearest);
    if (!nearest.hasHit()) return {};
    return {1, static_cast<double>(nearest.m_closestHitFraction) * factor * length};
  }

 private:
  btTriangleMesh soup_;
  std::unique_ptr<btBvhTriangleMeshShape> shape_;
  btCollisionObject object_;
  double reach_ = 0;
};

PeerAnswer sphere_triangle(const double* q) {
  btSphereShape sphere(static_cast<btScalar>(q[3]));
  btTriangleShape triangle(vector(q + 4), vector(q + 7), vector(q + 10));
  SphereTriangleDetector detector(&sphere, &triangle, 0);
  btDiscreteCollisionDetectorInterface::ClosestPointInput input;
  input.m_transformA = btTransform(btQuaternion::getIdentity(), vector(q));
  input.m_transformB = btTransform::getIdentity();
  Deepest deepest;
  detector.getClosestPoints(input, deepest, nullptr);
  return deepest.answer();
}

btTransform placed(const double* q) {
  const double* a = q + 3;
  const btMatrix3x3 rows(static_cast<btScalar>(a[0]), static_cast<btScalar>(a[3]), static_cast<btScalar>(a[6]),
                         static_cast<btScalar>(a[1]), static_cast<btScalar>(a[4]), static_cast<btScalar>(a[7]),
                         static_cast<btScalar>(a[2]), static_cast<btScalar>(a[5]), static_cast<btScalar>(a[8]));
  return btTransform(rows, vector(q));
}

PeerAnswer box_box(const double* q) {
  // The margin is part of a box's size, but may not be larger than the box.
  btBoxShape a(vector(q + 12));
  btBoxShape b(vector(q + 27));
  btBoxBoxDetector detector(&a, &b);
  btDiscreteCollisionDetectorInterface::ClosestPointInput input;
  input.m_transformA = placed(q);
  input.m_transformB = placed(q + 15);
  Deepest deepest;
  detector.getClosestPoints(input, deepest, nullptr);
  return deepest.answer();
}

PeerAnswer time_of_contact(const double* q) {
  btSphereShape sphere(static_cast<btScalar>(q[6]));
  btTriangleShape triangle(vector(q + 7), vector(q + 10), vector(q + 13));
  triangle.setMargin(0);
  btVoronoiSimplexSolver simplex;
  btSubsimplexConvexCast cast(&sphere, &triangle, &simplex);
  btConvexCast::CastResult result;
  const btTransform none = btTransform::getIdentity();
  const btTransform from(btQuaternion::getIdentity(), vector(q));
  const btTransform to(btQuaternion::getIdentity(), vector(q + 3));
  if (!cast.calcTimeOfImpact(from, to, none, none, result)) return {};
  return {1, static_cast<double>(result.m_fraction)};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  const report::PeerProblem problem = report::read_problem(argv[1]);
  if (problem.kind == "ray") {
    RayScene scene(problem.mesh);
    return report::serve_peer(problem, argv[2], [&](const double* q) { return scene.shoot(q); });
  }
  if (problem.kind == "sphere_triangle") return report::serve_peer(problem, argv[2], sphere_triangle);
  if (problem.kind == "box_box") return report::serve_peer(problem, argv[2], box_box);
  if (problem.kind == "time") return report::serve_peer(problem, argv[2], time_of_contact);
  return 3;
}
