#pragma once

#include <optional>
#include <span>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// The convex hull of the points: its corners, in the order given, and its faces, closed and counter-clockwise seen
/// from outside. Every sign is exact, so points on a face, on an edge, or given twice add nothing.
///
/// returns  nothing if the points lie in one plane, or so far apart that exact arithmetic in double runs out of room
/// cost     points times faces
/// source   incremental: de Berg et al., "Computational Geometry", 2008, chapter 11
std::optional<TriangleMesh> convex_hull(std::span<const Vec3> points);

}  // namespace collided::engine
