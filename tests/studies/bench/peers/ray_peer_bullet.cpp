#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>

#include "tests/studies/bench/peers/bullet_mesh.hpp"
#include "tests/studies/bench/peers/ray_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

struct Nearest final : btTriangleRaycastCallback {
  std::uint32_t triangle = 0xffffffffu;
  using btTriangleRaycastCallback::btTriangleRaycastCallback;
  btScalar reportHit(const btVector3&, btScalar fraction, int, int index) override {
    triangle = static_cast<std::uint32_t>(index);
    return fraction;  // only what is nearer from now on
  }
};

class Bullet final : public RayPeer {
 public:
  explicit Bullet(const TriangleMesh& mesh) : mesh_(mesh), beyond_(beyond(mesh)) {}
  std::string name() const override { return "Bullet"; }
  std::uint32_t nearest(const Ray& ray) override {
    const btVector3 from = bullet(ray.origin);
    const btVector3 to = bullet(ray.origin + beyond_ / ray.direction.norm() * ray.direction);
    Nearest found(from, to);
    mesh_.shape->performRaycast(&found, from, to);
    return found.triangle;
  }

 private:
  BulletMesh mesh_;
  double beyond_;
};

}  // namespace

std::unique_ptr<RayPeer> bullet_ray_peer(const TriangleMesh& mesh) { return std::make_unique<Bullet>(mesh); }

}  // namespace collided::bench
