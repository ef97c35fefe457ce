#include <btBulletCollisionCommon.h>

#include <variant>

#include "tests/studies/bench/peers/step_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

btVector3 point(const Vec3& v) {
  return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
}

std::unique_ptr<btCollisionShape> shape_of(const Primitive& shape) {
  if (const auto* ball = std::get_if<Sphere>(&shape)) {
    return std::make_unique<btSphereShape>(static_cast<btScalar>(ball->radius_m));
  }
  return std::make_unique<btBoxShape>(point(std::get<Box>(shape).half_m));
}

/// Bodies at rest are asleep: pairs of them are not tested again.
class Bullet final : public StepPeer {
 public:
  explicit Bullet(const StepBodies& bodies)
      : dispatcher_(&configuration_), world_(&dispatcher_, &broad_, &configuration_), moving_(bodies.moving) {
    world_.setForceUpdateAllAabbs(false);
    objects_.resize(bodies.shapes.size());
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      shapes_.push_back(shape_of(bodies.shapes[i]));
      objects_[i].setCollisionShape(shapes_.back().get());
      place(i, bodies.poses[i]);
      world_.addCollisionObject(&objects_[i]);
      if (i >= moving_) objects_[i].forceActivationState(ISLAND_SLEEPING);
    }
  }
  ~Bullet() override {
    for (auto& object : objects_) world_.removeCollisionObject(&object);
  }
  Bullet(const Bullet&) = delete;
  Bullet& operator=(const Bullet&) = delete;
  std::string name() const override { return "Bullet world"; }
  void step(std::span<const Pose> poses) override {
    for (std::size_t i = 0; i < moving_; ++i) place(i, poses[i]);
    world_.performDiscreteCollisionDetection();
  }
  std::size_t pairs() const override {
    std::size_t count = 0;
    for (int i = 0; i < dispatcher_.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher_.getManifoldByIndexInternal(i);
      const bool is_active = manifold.getBody0()->isActive() || manifold.getBody1()->isActive();
      bool touches = false;
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        touches = touches || manifold.getContactPoint(k).getDistance() <= 0;
      }
      count += is_active && touches ? 1 : 0;
    }
    return count;
  }

 private:
  void place(std::size_t i, const Pose& pose) {
    const Quat& q = pose.rotation;
    objects_[i].setWorldTransform(btTransform(btQuaternion(static_cast<btScalar>(q.x()), static_cast<btScalar>(q.y()),
                                                           static_cast<btScalar>(q.z()), static_cast<btScalar>(q.w())),
                                              point(pose.position)));
  }

  btDefaultCollisionConfiguration configuration_;
  mutable btCollisionDispatcher dispatcher_;  // it has no way to read its manifolds as const
  btDbvtBroadphase broad_;
  btCollisionWorld world_;
  std::size_t moving_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<btCollisionObject> objects_;
};

}  // namespace

std::unique_ptr<StepPeer> bullet_steps(const StepBodies& bodies) { return std::make_unique<Bullet>(bodies); }

}  // namespace collided::bench
