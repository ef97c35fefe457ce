#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>

#include <algorithm>

#include "tests/studies/homework/method.hpp"

namespace collided::homework {
using namespace engine;
namespace {

btScalar scalar(double x) { return static_cast<btScalar>(x); }
btVector3 vector(const Vec3& v) { return {scalar(v[0]), scalar(v[1]), scalar(v[2])}; }

/// Its collision world with GImpact meshes without margin, in single precision: objects that have a contact of no
/// positive distance.
class Bullet final : public Method {
 public:
  explicit Bullet(const Recording& recording)
      : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &configuration_) {
    btGImpactCollisionAlgorithm::registerAlgorithm(&dispatcher_);
    for (const auto& size : recording.sizes) {
      meshes_.push_back(std::make_unique<btTriangleMesh>());
      for (std::uint32_t t = 0; t < size->mesh->triangles.size(); ++t) {
        const Triangle corners = size->mesh->triangle(t);
        meshes_.back()->addTriangle(vector(corners.a), vector(corners.b), vector(corners.c));
      }
    }
    for (std::size_t i = 0; i < recording.objects(); ++i) {
      // A shape keeps its object's place while it is tested, so each has its own; they share the triangles.
      shapes_.push_back(std::make_unique<btGImpactMeshShape>(meshes_[recording.size_of[i]].get()));
      shapes_.back()->setMargin(0);
      shapes_.back()->updateBound();
      objects_.push_back(std::make_unique<btCollisionObject>());
      objects_.back()->setCollisionShape(shapes_.back().get());
      objects_.back()->setUserIndex(static_cast<int>(i));
      objects_.back()->setContactProcessingThreshold(0);
      place(i, recording.poses[0][i]);
      world_.addCollisionObject(objects_.back().get());
    }
  }
  ~Bullet() override {
    for (const auto& object : objects_) world_.removeCollisionObject(object.get());
  }
  std::string name() const override { return "Bullet"; }
  void frame(const std::vector<Pose>& poses) override {
    for (std::size_t i = 0; i < poses.size(); ++i) place(i, poses[i]);
    world_.performDiscreteCollisionDetection();
  }
  ObjectPairs pairs() const override {
    ObjectPairs all;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold =
          *const_cast<btCollisionDispatcher&>(dispatcher_).getManifoldByIndexInternal(i);
      bool meets = false;
      for (int c = 0; c < manifold.getNumContacts(); ++c)
        meets = meets || manifold.getContactPoint(c).getDistance() <= 0;
      if (!meets) continue;
      const auto a = static_cast<std::uint32_t>(manifold.getBody0()->getUserIndex());
      const auto b = static_cast<std::uint32_t>(manifold.getBody1()->getUserIndex());
      all.push_back({std::min(a, b), std::max(a, b)});
    }
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    return all;
  }
  std::size_t candidates() const override {
    return static_cast<std::size_t>(
        const_cast<btDbvtBroadphase&>(broadphase_).getOverlappingPairCache()->getNumOverlappingPairs());
  }

 private:
  void place(std::size_t i, const Pose& pose) {
    const Quat& q = pose.rotation;
    objects_[i]->setWorldTransform(
        btTransform(btQuaternion(scalar(q.x()), scalar(q.y()), scalar(q.z()), scalar(q.w())), vector(pose.position)));
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btCollisionWorld world_;
  std::vector<std::unique_ptr<btTriangleMesh>> meshes_;
  std::vector<std::unique_ptr<btGImpactMeshShape>> shapes_;
  std::vector<std::unique_ptr<btCollisionObject>> objects_;
};

}  // namespace

std::unique_ptr<Method> bullet_objects(const Recording& recording) {
  // Every object has a tree of its own: 300 bytes a triangle.
  if (recording.objects() * recording.polygons > 8'000'000) return nullptr;
  return std::make_unique<Bullet>(recording);
}

}  // namespace collided::homework
