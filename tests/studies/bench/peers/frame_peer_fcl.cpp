#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/shape/box.h>

#include <vector>

#include "tests/studies/bench/peers/frame_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

/// Its manager over a dynamic tree of boxes.
class Fcl final : public FramePeer {
 public:
  explicit Fcl(std::span<const Aabb> boxes) {
    for (const Aabb& box : boxes) {
      const Vec3 size = box.high - box.low;
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(std::make_shared<fcl::Boxd>(size)));
      objects_.back()->setTranslation((box.low + box.high) / 2);
      objects_.back()->computeAABB();
    }
    // In one go: a tree of objects that came one by one is a hundred times as slow.
    std::vector<fcl::CollisionObjectd*> all;
    for (const auto& object : objects_) all.push_back(object.get());
    manager_.registerObjects(all);
    manager_.setup();
  }
  std::string name() const override { return "FCL DynamicAABBTree"; }
  std::size_t frame(std::span<const Aabb> boxes) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      objects_[i]->setTranslation((boxes[i].low + boxes[i].high) / 2);
      objects_[i]->computeAABB();
    }
    manager_.update();
    std::size_t count = 0;
    manager_.collide(&count, [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* to) {
      // The manager also names pairs whose boxes are apart.
      if (a->getAABB().overlap(b->getAABB())) ++*static_cast<std::size_t*>(to);
      return false;
    });
    return count;
  }

 private:
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd manager_;
};

}  // namespace

std::unique_ptr<FramePeer> fcl_frames(std::span<const Aabb> boxes) { return std::make_unique<Fcl>(boxes); }

}  // namespace collided::bench
