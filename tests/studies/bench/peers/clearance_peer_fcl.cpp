#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/broadphase/default_broadphase_callbacks.h>

#include "tests/studies/bench/peers/clearance_peers.hpp"
#include "tests/studies/bench/peers/fcl_mesh.hpp"

namespace collided::bench {
namespace {

/// Two managers, as MoveIt keeps them: one for the robot, one for what is around it.
class FclManagers final : public ClearancePeer {
 public:
  FclManagers(const std::vector<TriangleMesh>& links, const std::vector<TriangleMesh>& cell) {
    for (const TriangleMesh& mesh : links) add(mesh, robot_, links_);
    for (const TriangleMesh& mesh : cell) add(mesh, around_, cell_);
    robot_.setup();
    around_.setup();
  }
  std::string name() const override { return "FCL"; }
  double distance_m(std::span<const Pose> poses) override {
    for (std::size_t i = 0; i < links_.size(); ++i) {
      const Frame frame = frame_of(poses[i]);
      links_[i]->setTransform(frame.rotation, frame.position);
      links_[i]->computeAABB();
    }
    robot_.update();
    fcl::DefaultDistanceData<double> data;
    data.request.enable_nearest_points = true;
    robot_.distance(&around_, &data, fcl::DefaultDistanceFunction<double>);
    return data.result.min_distance;
  }

 private:
  using Objects = std::vector<std::unique_ptr<fcl::CollisionObject<double>>>;
  static void add(const TriangleMesh& mesh, fcl::DynamicAABBTreeCollisionManager<double>& manager, Objects& objects) {
    objects.push_back(std::make_unique<fcl::CollisionObject<double>>(fcl_mesh(mesh)));
    manager.registerObject(objects.back().get());
  }

  Objects links_;
  Objects cell_;
  fcl::DynamicAABBTreeCollisionManager<double> robot_;
  fcl::DynamicAABBTreeCollisionManager<double> around_;
};

}  // namespace

std::unique_ptr<ClearancePeer> fcl_clearance_peer(const std::vector<TriangleMesh>& links,
                                                  const std::vector<TriangleMesh>& cell) {
  return std::make_unique<FclManagers>(links, cell);
}

}  // namespace collided::bench
