#include "tests/studies/report/measured/levels.hpp"

#include <algorithm>
#include <cmath>

#include "tests/studies/report/methods/near_walk.hpp"

namespace collided::report {
using namespace engine;

Row level_row(const std::string& study, const std::string& scene, const std::string& label, const TriangleMesh& mesh,
              const std::vector<Vec3>& points, const std::vector<double>& truth_m, double bound_m, int repeats) {
  const Bvh tree = Bvh::build(mesh);
  Row row{.study = study,
          .scene = scene,
          .series = "ours",
          .label = label,
          .knob = static_cast<double>(mesh.triangles.size()),
          .n = static_cast<long>(points.size())};
  std::vector<double> seconds;
  std::vector<double> errors;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    std::vector<Answer> answers(points.size());
    seconds.push_back(timed([&] {
      for (std::size_t i = 0; i < points.size(); ++i)
        answers[i] = nearest_in(tree, mesh, points[i], certified_distance);
    }));
    if (repeat > 0) continue;
    for (std::size_t i = 0; i < points.size(); ++i) errors.push_back(std::abs(answers[i].value - truth_m[i]));
  }
  std::sort(seconds.begin(), seconds.end());
  std::sort(errors.begin(), errors.end());
  const double to_ns = 1e9 / static_cast<double>(points.size());
  row.ns = to_ns * seconds[seconds.size() / 2];
  row.ns_low = to_ns * seconds.front();
  row.ns_high = to_ns * seconds.back();
  row.error_max = errors.back();
  row.error_p50 = errors[errors.size() / 2];
  row.bound_ratio = bound_m > 0 ? row.error_max / bound_m : (row.error_max > 0 ? INFINITY : 0.0);
  row.note = "proved bound " + short_number(bound_m, 4) + " m";
  return row;
}

}  // namespace collided::report
