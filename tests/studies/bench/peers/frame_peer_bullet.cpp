#include <BulletCollision/BroadphaseCollision/btAxisSweep3.h>
#include <BulletCollision/BroadphaseCollision/btDbvt.h>

#include <vector>

#include "tests/studies/bench/peers/frame_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

btVector3 point(const Vec3& v) {
  return {static_cast<btScalar>(v[0]), static_cast<btScalar>(v[1]), static_cast<btScalar>(v[2])};
}

struct Counter final : btDbvt::ICollide {
  std::size_t count = 0;
  void Process(const btDbvtNode*, const btDbvtNode*) override { ++count; }
};

/// Its dynamic tree of boxes against itself, without margins: in single precision, so a pair may differ at a touch.
class BulletTree final : public FramePeer {
 public:
  explicit BulletTree(std::span<const Aabb> boxes) {
    for (const Aabb& box : boxes) leaves_.push_back(tree_.insert(volume_of(box), nullptr));
    tree_.optimizeTopDown();
  }
  std::string name() const override { return "Bullet btDbvt"; }
  std::size_t frame(std::span<const Aabb> boxes) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      btDbvtVolume volume = volume_of(boxes[i]);
      tree_.update(leaves_[i], volume);
    }
    Counter counter;
    tree_.collideTT(tree_.m_root, tree_.m_root, counter);
    return counter.count;
  }

 private:
  static btDbvtVolume volume_of(const Aabb& box) { return btDbvtVolume::FromMM(point(box.low), point(box.high)); }

  btDbvt tree_;
  std::vector<btDbvtNode*> leaves_;
};

/// Its sweep and prune along three axes, which keeps the pairs between frames; in single precision and rounded to its
/// own raster, so pairs are checked as they are counted.
class BulletSweep final : public FramePeer {
 public:
  explicit BulletSweep(std::span<const Aabb> boxes) {
    Aabb world;
    for (const Aabb& box : boxes) world.extend(box);
    const Vec3 margin = 0.1 * (world.high - world.low);
    sweep_ = std::make_unique<bt32BitAxisSweep3>(point(world.low - margin), point(world.high + margin),
                                                 static_cast<unsigned>(boxes.size() + 2));
    for (const Aabb& box : boxes) {
      proxies_.push_back(sweep_->createProxy(point(box.low), point(box.high), 0, nullptr, 1, 1, nullptr));
    }
  }
  std::string name() const override { return "Bullet bt32BitAxisSweep3"; }
  std::size_t frame(std::span<const Aabb> boxes) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      sweep_->setAabb(proxies_[i], point(boxes[i].low), point(boxes[i].high), nullptr);
    }
    const btBroadphasePairArray& pairs = sweep_->getOverlappingPairCache()->getOverlappingPairArray();
    std::size_t count = 0;
    for (int i = 0; i < pairs.size(); ++i) {
      const btBroadphaseProxy& a = *pairs[i].m_pProxy0;
      const btBroadphaseProxy& b = *pairs[i].m_pProxy1;
      count += TestAabbAgainstAabb2(a.m_aabbMin, a.m_aabbMax, b.m_aabbMin, b.m_aabbMax) ? 1 : 0;
    }
    return count;
  }

 private:
  std::unique_ptr<bt32BitAxisSweep3> sweep_;
  std::vector<btBroadphaseProxy*> proxies_;
};

}  // namespace

std::unique_ptr<FramePeer> bullet_frames(std::span<const Aabb> boxes) { return std::make_unique<BulletTree>(boxes); }

std::unique_ptr<FramePeer> bullet_sweep_frames(std::span<const Aabb> boxes) {
  // Each object that comes is sorted in one place at a time: filling it takes the square of the number.
  return boxes.size() <= 10'000 ? std::make_unique<BulletSweep>(boxes) : nullptr;
}

}  // namespace collided::bench
