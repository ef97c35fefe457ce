#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/studies/homework/study.hpp"
#include "tests/studies/report/page/page.hpp"

namespace collided::homework {
using namespace engine;

/// One of the homework's claims, asked of what was measured here.
struct Claim {
  std::string text;
  std::string method;
  std::string measured;
  std::string verdict;  // "true", "false" or "not decided": the intervals overlap or are unknown
};
std::vector<Claim> claims(const std::vector<Point>& points);

/// What each of the three parts of collision handling costs (detection, determination, response), a frame of one scene.
struct Parts {
  Problem problem;
  double detection_us = 0;
  double determination_us = 0;  // what contact points, normals and depths add
  double response_us = 0;
  double contacts = 0;
};
Parts measure_parts(std::uint64_t seed, bool quick);

/// Pictures of problem A (SVG files, left out where they are not there), the three sweeps with contacts beside the
/// time, exponents, claims, parts, environment, and what the original lacks.
std::vector<report::Figure> homework_figures(const std::vector<Point>& points, const Parts& parts,
                                             const report::Provenance& from, const std::filesystem::path& pictures);

void write_points(const std::filesystem::path& file, const std::vector<Point>& points, const report::Provenance& from);

}  // namespace collided::homework
