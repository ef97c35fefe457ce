#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <limits>

#include "tests/studies/bench/peers/fcl_mesh.hpp"
#include "tests/studies/bench/peers/mesh_pair_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

class Fcl final : public MeshPairPeer {
 public:
  Fcl(const TriangleMesh& a, const TriangleMesh& b) : a_(fcl_mesh(a)), b_(fcl_mesh(b)) {}
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
  std::optional<std::size_t> contacts() override {
    const fcl::CollisionRequest<double> request(std::numeric_limits<std::size_t>::max(), true);
    fcl::CollisionResult<double> result;
    fcl::collide(a_.get(), fcl::Transform3<double>::Identity(), b_.get(), pose_, request, result);
    return result.numContacts();
  }
  std::optional<double> distance_m() override {
    const fcl::DistanceRequest<double> request(true);
    fcl::DistanceResult<double> result;
    return fcl::distance(a_.get(), fcl::Transform3<double>::Identity(), b_.get(), pose_, request, result);
  }

 private:
  std::shared_ptr<FclMesh> a_;
  std::shared_ptr<FclMesh> b_;
  fcl::Transform3<double> pose_ = fcl::Transform3<double>::Identity();
};

}  // namespace

std::unique_ptr<MeshPairPeer> fcl_pair_peer(const TriangleMesh& a, const TriangleMesh& b) {
  return std::make_unique<Fcl>(a, b);
}

}  // namespace collided::bench
