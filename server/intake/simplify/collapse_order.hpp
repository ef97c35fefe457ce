#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// One step of simplifying a mesh: corners at vertex `removed` go to vertex `kept`, and triangles that then have two
/// equal corners vanish.
struct EdgeCollapse {
  std::uint32_t removed;
  std::uint32_t kept;
};

/// The steps from a mesh to its simplest form, each of which removes one vertex. The first k steps, for any k, make a
/// level of detail. Vertices never move, and a triangle that remains keeps its number.
using CollapseOrder = std::vector<EdgeCollapse>;

/// A level of detail: triangles of the original by number, with their corners at that level.
struct LevelTriangles {
  std::vector<TriangleCorners> triangles;
  std::vector<std::uint32_t> originals;  // numbers in the original mesh, ascending; one per triangle
};

/// Why the steps cannot be applied to a mesh with that many vertices; empty: they can. Each vertex may be removed at
/// most once, in favour of one that has not been removed itself.
/// cost  O(steps)
std::string flaw_of(const CollapseOrder& order, std::size_t vertex_count);

/// The mesh after the first collapse_count steps. The order must have no flaw.
/// cost  O(triangles)
LevelTriangles level_after(const TriangleMesh& mesh, const CollapseOrder& order, std::size_t collapse_count);

/// The level with the fewest steps that has at most that many triangles; if there is none, the simplest level.
/// cost  O(triangles + steps)
LevelTriangles level_with(const TriangleMesh& mesh, const CollapseOrder& order, std::size_t triangles_at_most);

/// A level as a separate mesh, with only the vertices that it uses, in their order.
TriangleMesh compact_mesh(const TriangleMesh& mesh, const LevelTriangles& level);

}  // namespace collided::engine
