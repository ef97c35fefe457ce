#pragma once

#include <string>
#include <vector>

#include "server/geometry/mesh.hpp"
#include "tests/studies/report/measure.hpp"

namespace collided::report {
using namespace engine;

/// One level of detail: how far its distances are off, their time, and the proved bound on the former.
/// truth_m  distance of each point from what the level stands for
Row level_row(const std::string& study, const std::string& scene, const std::string& label, const TriangleMesh& mesh,
              const std::vector<Vec3>& points, const std::vector<double>& truth_m, double bound_m, int repeats);

}  // namespace collided::report
