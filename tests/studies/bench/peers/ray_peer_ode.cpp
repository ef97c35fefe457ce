#include <algorithm>

#include "tests/studies/bench/peers/ode_mesh.hpp"
#include "tests/studies/bench/peers/ray_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

class Ode final : public RayPeer {
 public:
  explicit Ode(const TriangleMesh& mesh) : mesh_(mesh), ray_(dCreateRay(nullptr, static_cast<dReal>(beyond(mesh)))) {
    dGeomRaySetClosestHit(ray_, 1);
    dGeomRaySetBackfaceCull(ray_, 0);
  }
  ~Ode() override { dGeomDestroy(ray_); }
  std::string name() const override { return "ODE"; }
  std::uint32_t nearest(const Ray& ray) override {
    const auto o = [&](int axis) { return static_cast<dReal>(ray.origin[axis]); };
    const auto d = [&](int axis) { return static_cast<dReal>(ray.direction[axis]); };
    dGeomRaySet(ray_, o(0), o(1), o(2), d(0), d(1), d(2));
    dContactGeom contact;
    if (dCollide(ray_, mesh_.geometry, 1, &contact, sizeof contact) == 0) return 0xffffffffu;
    return static_cast<std::uint32_t>(std::max(contact.side1, contact.side2));
  }

 private:
  OdeRuns runs_;
  OdeMesh mesh_;
  dGeomID ray_;
};

}  // namespace

std::unique_ptr<RayPeer> ode_ray_peer(const TriangleMesh& mesh) { return std::make_unique<Ode>(mesh); }

}  // namespace collided::bench
