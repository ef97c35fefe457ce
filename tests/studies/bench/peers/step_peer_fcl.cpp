#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>

#include <variant>

#include "tests/studies/bench/peers/step_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

std::shared_ptr<fcl::CollisionGeometryd> geometry_of(const Primitive& shape) {
  if (const auto* ball = std::get_if<Sphere>(&shape)) return std::make_shared<fcl::Sphered>(ball->radius_m);
  return std::make_shared<fcl::Boxd>(Vec3(2 * std::get<Box>(shape).half_m));
}

struct Search {
  fcl::CollisionRequestd request;
  std::size_t count = 0;
  const fcl::CollisionObjectd* moving_end = nullptr;
  const fcl::CollisionObjectd* asked = nullptr;  // whose pairs are looked for; null: all
};

/// Of two moving bodies the pair is left to the first.
bool look_at(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* to) {
  Search& search = *static_cast<Search*>(to);
  if (a == b) return false;
  if (search.asked != nullptr) {
    const fcl::CollisionObjectd* other = a == search.asked ? b : a;
    if (other < search.asked && other < search.moving_end) return false;
  }
  fcl::CollisionResultd result;
  search.count += fcl::collide(a, b, search.request, result) > 0 ? 1 : 0;
  return false;
}

class Fcl final : public StepPeer {
 public:
  Fcl(const StepBodies& bodies, bool contacts) : contacts_(contacts), moving_(bodies.moving) {
    objects_.reserve(bodies.shapes.size());
    for (std::size_t i = 0; i < bodies.shapes.size(); ++i) {
      objects_.emplace_back(geometry_of(bodies.shapes[i]));
      place(i, bodies.poses[i]);
    }
    std::vector<fcl::CollisionObjectd*> all;
    for (auto& object : objects_) all.push_back(&object);
    manager_.registerObjects(all);
    manager_.setup();
  }
  std::string name() const override { return contacts_ ? "FCL tree + contacts" : "FCL tree, yes or no"; }
  void step(std::span<const Pose> poses) override {
    for (std::size_t i = 0; i < moving_; ++i) place(i, poses[i]);
    Search search{.request = {1, contacts_}, .moving_end = objects_.data() + moving_};
    if (moving_ == objects_.size()) {
      manager_.update();
      manager_.collide(&search, look_at);
    } else {
      for (std::size_t i = 0; i < moving_; ++i) manager_.update(&objects_[i]);
      for (std::size_t i = 0; i < moving_; ++i) {
        search.asked = &objects_[i];
        manager_.collide(&objects_[i], &search, look_at);
      }
    }
    pairs_ = search.count;
  }
  std::size_t pairs() const override { return pairs_; }

 private:
  void place(std::size_t i, const Pose& pose) {
    objects_[i].setTransform(pose.rotation, pose.position);
    objects_[i].computeAABB();
  }

  bool contacts_;
  std::size_t moving_;
  std::size_t pairs_ = 0;
  std::vector<fcl::CollisionObjectd> objects_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
};

}  // namespace

std::unique_ptr<StepPeer> fcl_steps(const StepBodies& bodies, bool contacts) {
  return std::make_unique<Fcl>(bodies, contacts);
}

}  // namespace collided::bench
