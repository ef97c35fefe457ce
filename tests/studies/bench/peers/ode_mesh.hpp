#pragma once

#include <ode/ode.h>

#include <cstdarg>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::bench {
using namespace engine;

/// ODE runs from the first of these to the last one's end.
class OdeRuns {
 public:
  OdeRuns() : started_(dInitODE2(0) != 0) { dSetMessageHandler(keep_quiet); }
  ~OdeRuns() {
    if (started_) dCloseODE();
  }
  OdeRuns(const OdeRuns&) = delete;
  OdeRuns& operator=(const OdeRuns&) = delete;

 private:
  /// It reports a full hash bucket on every call with many contacts.
  static void keep_quiet(int, const char*, va_list) {}

  bool started_;
};

/// A mesh as ODE's geometry.
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
  ~OdeMesh() {
    dGeomDestroy(geometry);
    dGeomTriMeshDataDestroy(data);
  }
  OdeMesh(const OdeMesh&) = delete;
  OdeMesh& operator=(const OdeMesh&) = delete;
};

}  // namespace collided::bench
