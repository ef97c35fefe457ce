#include <algorithm>
#include <random>

#include "server/exact_phase/distance/closest.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/studies/report/measured/levels.hpp"
#include "tests/studies/report/measured/studies.hpp"
#include "tests/studies/report/methods/near_walk.hpp"

namespace collided::report {
using namespace engine;

std::vector<Row> study_tessellation(const Setting& setting) {
  std::mt19937_64 random(setting.seed + 4);
  const int count = setting.count(2000);
  const std::vector<Vec3> points = points_around(scenes::icosphere(4, 2), count, random);
  std::vector<Vec3> outside;
  std::vector<double> truth_m;
  for (const Vec3& p : points) {
    const Closest found = closest(p, Sphere{Vec3::Zero(), 1});
    if (found.distance_m == 0) continue;
    outside.push_back(p);
    truth_m.push_back(found.distance_m);
  }
  const std::string scene = "unit sphere, points outside";
  std::vector<Row> rows;
  for (int level = 0; level <= (setting.quick ? 4 : 6); ++level) {
    const TriangleMesh mesh = scenes::icosphere(level, 1);
    // How deep the faces cut into the sphere: the corners are on it but for their rounding.
    double deviation_m = 0;
    for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      const Closest nearest = closest(Vec3::Zero(), mesh.triangle(i));
      deviation_m = std::max(deviation_m, 1 - (nearest.distance_m - nearest.distance_error_m));
    }
    rows.push_back(level_row("tessellation", scene, std::to_string(mesh.triangles.size()), mesh, outside, truth_m,
                             deviation_m + 0x1p-50, setting.repeats()));
  }
  Row sphere{.study = "tessellation",
             .scene = scene,
             .series = "the sphere itself",
             .label = "closed form",
             .knob = kUnknown,
             .n = static_cast<long>(outside.size())};
  double worst = 0;
  double sum = 0;
  const double seconds = timed([&] {
    for (const Vec3& p : outside) {
      const Closest found = closest(p, Sphere{Vec3::Zero(), 1});
      worst = std::max(worst, found.distance_error_m);
      sum += found.distance_m;
    }
  });
  sphere.ns = sphere.ns_low = sphere.ns_high = sum > 0 ? 1e9 * seconds / static_cast<double>(outside.size()) : kUnknown;
  sphere.error_max = worst;
  sphere.note = "error: its proved bound";
  rows.push_back(sphere);
  return rows;
}

}  // namespace collided::report
