#pragma once

#include <random>
#include <vector>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "tests/studies/report/measure.hpp"

namespace collided::report {
using namespace engine;

/// Distance of a point and a triangle, with a bound (0 where none is claimed).
using DistanceTo = Answer (*)(const Vec3&, const Triangle&);
Answer certified_distance(const Vec3& point, const Triangle& triangle);

/// The nearest of a mesh, as the product walks to it.
Answer nearest_in(const Bvh& tree, const TriangleMesh& mesh, const Vec3& point, DistanceTo distance);

/// From a millionth of the mesh's size to its whole size away from triangles at random; coordinates are floats.
std::vector<Vec3> points_around(const TriangleMesh& mesh, int count, std::mt19937_64& random);

}  // namespace collided::report
