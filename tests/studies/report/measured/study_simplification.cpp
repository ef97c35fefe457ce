#include <random>

#include "server/intake/simplify/simplify.hpp"
#include "server/world/objects/surface_distance.hpp"
#include "tests/studies/report/measured/levels.hpp"
#include "tests/studies/report/measured/studies.hpp"
#include "tests/studies/report/methods/near_walk.hpp"

namespace collided::report {
using namespace engine;
namespace {

/// The mesh that distances are asked of, and what they are.
struct Subject {
  NamedMesh scene;
  Bvh tree;
  std::vector<std::uint32_t> part_of;
  std::vector<Vec3> points;
  std::vector<double> truth_m;

  explicit Subject(const Setting& setting)
      : scene(report_mesh(setting.quick)), tree(Bvh::build(scene.mesh)), part_of(scene.mesh.triangles.size(), 0) {
    std::mt19937_64 random(setting.seed + 5);
    points = points_around(scene.mesh, setting.count(2000), random);
    for (const Vec3& p : points) truth_m.push_back(nearest_in(tree, scene.mesh, p, certified_distance).value);
  }

  double bound_m(const TriangleMesh& level) const {
    const Bvh level_tree = Bvh::build(level);
    const std::vector<std::uint32_t> level_part_of(level.triangles.size(), 0);
    return surface_distance({scene.mesh, tree, part_of}, {level, level_tree, level_part_of});
  }
};

}  // namespace

std::vector<Row> study_simplification(const Setting& setting) {
  const Subject subject(setting);
  const TriangleMesh& mesh = subject.scene.mesh;
  std::vector<Row> rows;
  for (const CollapseCost cost : {CollapseCost::quadric, CollapseCost::edge_length}) {
    const bool is_first = cost == CollapseCost::quadric;
    SimplifyReport report;
    CollapseOrder order;
    const double simplify_s = timed([&] { order = simplify(mesh, {.cost = cost}, report); });
    std::size_t last_count = 0;
    for (std::size_t divisor = 1; divisor <= (setting.quick ? 8 : 1024); divisor *= 2) {
      const TriangleMesh level = compact_mesh(mesh, level_with(mesh, order, mesh.triangles.size() / divisor));
      if (level.triangles.size() == last_count) break;
      last_count = level.triangles.size();
      Row row = level_row(is_first ? "simplification" : "simplification by length", subject.scene.name,
                          divisor == 1 ? "full" : "1/" + std::to_string(divisor), level, subject.points,
                          subject.truth_m, divisor == 1 ? 0 : subject.bound_m(level), setting.repeats());
      if (divisor == 1) row.note = "simplified as far as it goes in " + short_number(simplify_s, 3) + " s";
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace collided::report
