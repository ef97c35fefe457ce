#pragma once

#include <vector>

#include "server/geometry/mesh.hpp"
#include "tests/studies/report/measure.hpp"

namespace collided::report {
using namespace engine;

// The studies, one file each. Every one makes its questions from the seed, finds the truth, measures, returns rows.

/// Closest hit of a ray in a mesh: directions at random, and aimed at vertices, edges and along faces.
std::vector<Row> study_ray(const Setting& setting);
/// Depth of sphere and box in a triangle, of two boxes, of a sphere in a box.
std::vector<Row> study_depth(const Setting& setting);
/// Distance from a point to the nearest triangle of a mesh.
std::vector<Row> study_nearest(const Setting& setting);
/// Time of contact of a moving sphere and a triangle, and the width that is asked for.
std::vector<Row> study_time(const Setting& setting);
/// The same of a turning box and a ball.
std::vector<Row> study_turning(const Setting& setting);
/// Spheres made of ever more triangles against the sphere itself.
std::vector<Row> study_tessellation(const Setting& setting);
/// A mesh made simpler and simpler against the whole one.
std::vector<Row> study_simplification(const Setting& setting);
/// Scale times offset.
std::vector<Row> study_extremes(const Setting& setting);
/// Rays aimed at edges and vertices: how often the yes or no is wrong.
std::vector<Row> study_decisions(const Setting& setting);
/// The product's tree beside the lecture's two plain forms, over triangle counts.
std::vector<Row> study_index(const Setting& setting);
/// Time against triangles, rays a batch, threads and moving objects.
std::vector<Row> study_growth(const Setting& setting);
/// Crossings of two publishers' balls, told or not, against the phase between the two.
std::vector<Row> study_arrival(const Setting& setting);
/// What a step of moving objects spends its time on; n is the contacts that it found.
std::vector<Row> study_stages(const Setting& setting);

/// The bunny of glmark2-data with its coordinates rounded to float, so that float programs get the same question; an
/// icosphere where it is not installed.
struct NamedMesh {
  std::string name;
  TriangleMesh mesh;
};
NamedMesh report_mesh(bool small);

double extent(const TriangleMesh& mesh);

/// "1e-3" to "1e-12": what a caller may ask for.
std::vector<double> asked_errors(bool quick);

}  // namespace collided::report
