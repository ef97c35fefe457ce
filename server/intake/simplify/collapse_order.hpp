#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// One step of simplifying a mesh: every corner at `removed` goes to `kept`; triangles with two equal corners vanish.
struct EdgeCollapse {
  std::uint32_t removed;
  std::uint32_t kept;
};

/// The steps from a mesh to its simplest form, each one vertex number fewer. Any number of them from the first on is a
/// level of detail; vertices never move, and what is left of a triangle keeps its number.
using CollapseOrder = std::vector<EdgeCollapse>;

/// A level of detail: triangles of the original by number, with the corners that are left to them.
struct LevelTriangles {
  std::vector<TriangleCorners> triangles;
  std::vector<std::uint32_t> originals;  // numbers in the original mesh, ascending; one a triangle
};

/// Why the steps can't be taken on a mesh of that many vertices; empty: they can. Each vertex goes at most once, and
/// to one that is still there.
/// cost  O(steps)
std::string flaw_of(const CollapseOrder& order, std::size_t vertex_count);

/// What the first collapse_count steps leave of the mesh. The order must be without flaw.
/// cost  O(triangles)
LevelTriangles level_after(const TriangleMesh& mesh, const CollapseOrder& order, std::size_t collapse_count);

/// The level with the fewest collapses that has at most that many triangles, or the simplest there is.
/// cost  O(triangles + steps)
LevelTriangles level_with(const TriangleMesh& mesh, const CollapseOrder& order, std::size_t triangles_at_most);

/// A level as a mesh of its own, without vertices that it does not use. Vertices keep their order.
TriangleMesh compact_mesh(const TriangleMesh& mesh, const LevelTriangles& level);

}  // namespace collided::engine
