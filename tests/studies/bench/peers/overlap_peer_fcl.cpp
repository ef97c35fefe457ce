#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/peers/overlap_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

/// Its tree of oriented boxes and swept spheres.
class Fcl final : public OverlapPeer {
 public:
  explicit Fcl(const TriangleMesh& mesh) {
    std::vector<fcl::Triangle> triangles;
    for (const TriangleCorners& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
    const double start = thread_seconds();
    auto model = std::make_shared<Model>();
    model->beginModel();
    model->addSubModel(std::vector<fcl::Vector3d>(mesh.vertices.begin(), mesh.vertices.end()), triangles);
    model->endModel();
    mesh_ = std::make_unique<fcl::CollisionObjectd>(model);
    build_s = thread_seconds() - start;
  }
  std::string name() const override { return "FCL"; }

  long sphere(const Vec3& center, double radius_m, bool any) override {
    return collide(std::make_shared<fcl::Sphered>(radius_m), center, any);
  }
  long box(const Vec3& center, const Vec3& half_m, bool any) override {
    return collide(std::make_shared<fcl::Boxd>(2 * half_m[0], 2 * half_m[1], 2 * half_m[2]), center, any);
  }
  /// To a sphere of almost no radius; it has no point query.
  double closest_m(const Vec3& point) override {
    const fcl::CollisionObjectd object(std::make_shared<fcl::Sphered>(1e-12), at(point));
    fcl::DistanceRequestd request;
    fcl::DistanceResultd result;
    return fcl::distance(mesh_.get(), &object, request, result);
  }

 private:
  static fcl::Transform3d at(const Vec3& place) {
    fcl::Transform3d pose = fcl::Transform3d::Identity();
    pose.translation() = place;
    return pose;
  }
  long collide(const std::shared_ptr<fcl::CollisionGeometryd>& shape, const Vec3& center, bool any) {
    const fcl::CollisionObjectd object(shape, at(center));
    const fcl::CollisionRequestd request(any ? 1 : 1u << 30, false);
    fcl::CollisionResultd result;
    fcl::collide(mesh_.get(), &object, request, result);
    const auto count = static_cast<long>(result.numContacts());
    return any ? std::min(count, 1L) : count;
  }

  std::unique_ptr<fcl::CollisionObjectd> mesh_;
};

}  // namespace

std::unique_ptr<OverlapPeer> fcl_peer(const TriangleMesh& mesh) { return std::make_unique<Fcl>(mesh); }

}  // namespace collided::bench
