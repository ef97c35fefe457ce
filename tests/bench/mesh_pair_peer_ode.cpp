#include <ode/ode.h>

#include <cstdarg>

#include "tests/bench/mesh_pair_peers.hpp"

namespace collided::bench {
namespace {

constexpr int kMostContacts = 0xffff;  // all that a call can tell

/// It reports a full hash bucket on every call with many contacts.
void keep_quiet(int, const char*, va_list) {}

struct OdeMesh {
  std::vector<dReal> vertices;
  std::vector<dTriIndex> corners;
  dTriMeshDataID data = nullptr;
  dGeomID geometry = nullptr;

  explicit OdeMesh(const TriangleMesh& mesh) {
    for (const Vec3& vertex : mesh.vertices) {
      for (int axis = 0; axis < 3; ++axis) vertices.push_back(static_cast<dReal>(vertex[axis]));
    }
    for (const TriangleCorners& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
    data = dGeomTriMeshDataCreate();
    const auto build = sizeof(dReal) == sizeof(double) ? dGeomTriMeshDataBuildDouble : dGeomTriMeshDataBuildSingle;
    build(data, vertices.data(), 3 * sizeof(dReal), static_cast<int>(mesh.vertices.size()), corners.data(),
          static_cast<int>(corners.size()), 3 * sizeof(dTriIndex));
    geometry = dCreateTriMesh(nullptr, data, nullptr, nullptr, nullptr);
  }
  void free() {
    dGeomDestroy(geometry);
    dGeomTriMeshDataDestroy(data);
  }
};

/// Its contacts name their triangles; a pair whose contact it merged with another's is lost in the telling.
class Ode final : public MeshPairPeer {
 public:
  Ode(const TriangleMesh& a, const TriangleMesh& b)
      : started_(dInitODE2(0) != 0), a_(a), b_(b), contacts_(kMostContacts) {
    dSetMessageHandler(keep_quiet);
  }
  ~Ode() override {
    a_.free();
    b_.free();
    if (started_) dCloseODE();
  }
  std::string name() const override { return "ODE"; }
  void move(const Frame& frame) override {
    dMatrix3 rotation{};
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) rotation[4 * row + column] = static_cast<dReal>(frame.rotation(row, column));
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

 private:
  bool started_;
  OdeMesh a_;
  OdeMesh b_;
  std::vector<dContactGeom> contacts_;
};

}  // namespace

std::unique_ptr<MeshPairPeer> ode_pair_peer(const TriangleMesh& a, const TriangleMesh& b) {
  return std::make_unique<Ode>(a, b);
}

}  // namespace collided::bench
