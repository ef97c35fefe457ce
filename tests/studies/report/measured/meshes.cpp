#include "tests/scenes/meshes.hpp"
#include "tests/studies/bench/obj.hpp"
#include "tests/studies/report/measured/studies.hpp"

namespace collided::report {
using namespace engine;

NamedMesh report_mesh(bool small) {
  NamedMesh result{"bunny (glmark2-data)", bench::read_obj("/usr/share/glmark2/models/bunny.obj")};
  if (result.mesh.triangles.empty() || small) {
    result = {small ? "icosphere" : "icosphere", scenes::icosphere(small ? 3 : 6, 1)};
  }
  for (Vec3& vertex : result.mesh.vertices) {
    for (int k = 0; k < 3; ++k) vertex[k] = static_cast<double>(static_cast<float>(vertex[k]));
  }
  result.name += ", " + std::to_string(result.mesh.triangles.size()) + " triangles";
  return result;
}

double extent(const TriangleMesh& mesh) {
  double largest = 0;
  for (const Vec3& vertex : mesh.vertices) largest = std::max(largest, vertex.cwiseAbs().maxCoeff());
  return largest;
}

std::vector<double> asked_errors(bool quick) {
  if (quick) return {1e-3, 1e-9};
  return {1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12};
}

}  // namespace collided::report
