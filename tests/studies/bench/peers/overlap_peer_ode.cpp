#include <optional>

#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/peers/ode_mesh.hpp"
#include "tests/studies/bench/peers/overlap_peers.hpp"

namespace collided::bench {
using namespace engine;
namespace {

/// Its trimesh collider: contacts, merged, so that only yes and no can be compared.
class Ode final : public OverlapPeer {
 public:
  explicit Ode(const TriangleMesh& mesh) {
    const double start = thread_seconds();
    mesh_.emplace(mesh);
    sphere_ = dCreateSphere(nullptr, 1);
    box_ = dCreateBox(nullptr, 1, 1, 1);
    build_s = thread_seconds() - start;
  }
  ~Ode() override {
    for (const dGeomID geometry : {sphere_, box_}) dGeomDestroy(geometry);
  }
  std::string name() const override { return "ODE"; }
  bool only_any() const override { return true; }

  long sphere(const Vec3& center, double radius_m, bool any) override {
    dGeomSphereSetRadius(sphere_, static_cast<dReal>(radius_m));
    return collide(sphere_, center, any);
  }
  long box(const Vec3& center, const Vec3& half_m, bool any) override {
    const auto edge = [&](int axis) { return static_cast<dReal>(2 * half_m[axis]); };
    dGeomBoxSetLengths(box_, edge(0), edge(1), edge(2));
    return collide(box_, center, any);
  }

 private:
  long collide(dGeomID geometry, const Vec3& c, bool any) {
    dGeomSetPosition(geometry, static_cast<dReal>(c[0]), static_cast<dReal>(c[1]), static_cast<dReal>(c[2]));
    if (!any) return kCannot;
    dContactGeom contact;
    return dCollide(mesh_->geometry, geometry, 1 | static_cast<int>(CONTACTS_UNIMPORTANT), &contact, sizeof contact) > 0
               ? 1
               : 0;
  }

  OdeRuns runs_;
  std::optional<OdeMesh> mesh_;
  dGeomID sphere_ = nullptr;
  dGeomID box_ = nullptr;
};

}  // namespace

std::unique_ptr<OverlapPeer> ode_peer(const TriangleMesh& mesh) { return std::make_unique<Ode>(mesh); }

}  // namespace collided::bench
