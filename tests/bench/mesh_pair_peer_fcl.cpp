#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>

#include <limits>

#include "tests/bench/mesh_pair_peers.hpp"

namespace collided::bench {
namespace {

using Model = fcl::BVHModel<fcl::OBBRSS<double>>;

std::shared_ptr<Model> model_of(const TriangleMesh& mesh) {
  std::vector<fcl::Triangle> triangles;
  for (const TriangleCorners& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  auto model = std::make_shared<Model>();
  model->beginModel();
  model->addSubModel(mesh.vertices, triangles);
  model->endModel();
  return model;
}

class Fcl final : public MeshPairPeer {
 public:
  Fcl(const TriangleMesh& a, const TriangleMesh& b) : a_(model_of(a)), b_(model_of(b)) {}
  std::string name() const override { return "FCL"; }
  void move(const Frame& frame) override {
    pose_.linear() = frame.rotation;
    pose_.translation() = frame.position;
  }
  void all_pairs(TrianglePairs& out) override {
    fcl::CollisionRequest<double> request;
    request.num_max_contacts = std::numeric_limits<std::size_t>::max();
    fcl::CollisionResult<double> result;
    fcl::collide(a_.get(), fcl::Transform3<double>::Identity(), b_.get(), pose_, request, result);
    for (std::size_t i = 0; i < result.numContacts(); ++i) {
      const fcl::Contact<double>& contact = result.getContact(i);
      out.emplace_back(static_cast<std::uint32_t>(contact.b1), static_cast<std::uint32_t>(contact.b2));
    }
  }
  bool any() override {
    const fcl::CollisionRequest<double> request;
    fcl::CollisionResult<double> result;
    return fcl::collide(a_.get(), fcl::Transform3<double>::Identity(), b_.get(), pose_, request, result) > 0;
  }

 private:
  std::shared_ptr<Model> a_;
  std::shared_ptr<Model> b_;
  fcl::Transform3<double> pose_ = fcl::Transform3<double>::Identity();
};

}  // namespace

std::unique_ptr<MeshPairPeer> fcl_pair_peer(const TriangleMesh& a, const TriangleMesh& b) {
  return std::make_unique<Fcl>(a, b);
}

}  // namespace collided::bench
