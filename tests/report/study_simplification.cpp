#ifdef COLLIDED_MESHOPTIMIZER
#include <meshoptimizer.h>
#endif

#include <random>

#include "tests/report/hausdorff.hpp"
#include "tests/report/levels.hpp"
#include "tests/report/near_walk.hpp"
#include "tests/report/studies.hpp"

namespace collided::report {

#ifdef COLLIDED_MESHOPTIMIZER
namespace {

/// The mesh with about target triangles, by quadric error; vertices stay those of the mesh.
/// source  Garland, Heckbert, "Surface Simplification Using Quadric Error Metrics", 1997 (meshoptimizer's own variant)
TriangleMesh simplified(const TriangleMesh& mesh, std::size_t target) {
  std::vector<float> positions;
  for (const Vec3& v : mesh.vertices) {
    for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(v[k]));
  }
  std::vector<unsigned> indices;
  for (const TriangleCorners& t : mesh.triangles) indices.insert(indices.end(), t.begin(), t.end());
  std::vector<unsigned> kept(indices.size());
  kept.resize(meshopt_simplify(kept.data(), indices.data(), indices.size(), positions.data(), mesh.vertices.size(),
                               3 * sizeof(float), 3 * target, 1.0f, 0, nullptr));
  TriangleMesh result{mesh.vertices, {}};
  for (std::size_t i = 0; i + 2 < kept.size(); i += 3) result.triangles.push_back({kept[i], kept[i + 1], kept[i + 2]});
  return result;
}

}  // namespace

std::vector<Row> study_simplification(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 5);
  const NamedMesh scene = report_mesh(setting.quick);
  const BspTree tree = BspTree::build(scene.mesh);
  const std::vector<Vec3> points = points_around(scene.mesh, setting.count(2000), random);
  std::vector<double> truth_m;
  for (const Vec3& p : points) truth_m.push_back(nearest_in(tree, scene.mesh, p, certified_distance).value);
  std::vector<Row> rows;
  std::size_t last_count = 0;
  for (int divisor = 1; divisor <= (setting.quick ? 8 : 1024); divisor *= 2) {
    const TriangleMesh level =
        divisor == 1 ? scene.mesh : simplified(scene.mesh, scene.mesh.triangles.size() / divisor);
    if (level.triangles.size() == last_count || level.triangles.empty()) break;
    last_count = level.triangles.size();
    const double bound_m = divisor == 1 ? 0 : two_sided_hausdorff(scene.mesh, level, setting.quick ? 1000 : 200000);
    rows.push_back(level_row("simplification", scene.name, divisor == 1 ? "full" : "1/" + std::to_string(divisor),
                             level, points, truth_m, bound_m, setting.repeats()));
  }
  return rows;
}
#else
std::vector<Row> study_simplification(const Setting&) { return {}; }
#endif

}  // namespace collided::report
