#pragma once

#include <cstddef>

#include "server/geometry/mesh.hpp"

namespace collided::report {

/// A bound on the distance of any point of either mesh to the other one: no distance to one mesh can differ from the
/// distance to the other by more.
///
/// pieces_at_most  triangles may be cut into so many pieces; with fewer the bound holds too, but is wider
double two_sided_hausdorff(const TriangleMesh& a, const TriangleMesh& b, std::size_t pieces_at_most);

}  // namespace collided::report
