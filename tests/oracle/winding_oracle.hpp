#pragma once

#include "server/geometry/mesh.hpp"

namespace collided::oracle {
using namespace engine;

/// The generalised winding number by the plain sum over all triangles in long double, without an index. Its own error,
/// for points that are not in a triangle's plane to rounding, is some 1e-18 times the triangles.
/// source  Jacobson, Kavan, Sorkine-Hornung 2013
long double winding_by_sum(const TriangleMesh& mesh, const Vec3& point);

}  // namespace collided::oracle
