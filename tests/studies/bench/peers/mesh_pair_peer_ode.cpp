#include "tests/studies/bench/peers/mesh_pair_peers.hpp"
#include "tests/studies/bench/peers/ode_mesh.hpp"

namespace collided::bench {
using namespace engine;
namespace {

constexpr int kMostContacts = 0xffff;  // all that a call can tell

/// Its contacts name their triangles; a pair whose contact it merged with another's is lost in the telling.
class Ode final : public MeshPairPeer {
 public:
  Ode(const TriangleMesh& a, const TriangleMesh& b) : a_(a), b_(b), contacts_(kMostContacts) {}
  std::string name() const override { return "ODE"; }
  void move(const Frame& frame) override {
    dMatrix3 rotation{};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        rotation[4 * row + column] = static_cast<dReal>(frame.rotation(row, column));
    }
    dGeomSetRotation(b_.geometry, rotation);
    const Vec3& p = frame.position;
    dGeomSetPosition(b_.geometry, static_cast<dReal>(p[0]), static_cast<dReal>(p[1]), static_cast<dReal>(p[2]));
  }
  void all_pairs(TrianglePairs& out) override {
    const int count = dCollide(a_.geometry, b_.geometry, kMostContacts, contacts_.data(), sizeof(dContactGeom));
    for (int i = 0; i < count; ++i) {
      out.emplace_back(static_cast<std::uint32_t>(contacts_[static_cast<std::size_t>(i)].side1),
                       static_cast<std::uint32_t>(contacts_[static_cast<std::size_t>(i)].side2));
    }
  }
  bool any() override {
    const int flags = 1 | static_cast<int>(CONTACTS_UNIMPORTANT);
    return dCollide(a_.geometry, b_.geometry, flags, contacts_.data(), sizeof(dContactGeom)) > 0;
  }
  std::optional<std::size_t> contacts() override {
    return static_cast<std::size_t>(
        dCollide(a_.geometry, b_.geometry, kMostContacts, contacts_.data(), sizeof(dContactGeom)));
  }

 private:
  OdeRuns runs_;
  OdeMesh a_;
  OdeMesh b_;
  std::vector<dContactGeom> contacts_;
};

}  // namespace

std::unique_ptr<MeshPairPeer> ode_pair_peer(const TriangleMesh& a, const TriangleMesh& b) {
  return std::make_unique<Ode>(a, b);
}

}  // namespace collided::bench
