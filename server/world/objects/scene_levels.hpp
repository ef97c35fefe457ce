#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/mesh.hpp"
#include "server/intake/scene.hpp"
#include "server/intake/simplify/collapse_order.hpp"

namespace collided::engine {

/// A simpler form of a scene's mesh: distances to its parts differ from those to the scene's own by at most off_by_m.
struct SceneLevel {
  TriangleMesh mesh;
  Bvh tree;
  std::vector<std::uint32_t> originals;  // the triangle of the scene's mesh for each own triangle
  std::vector<std::uint32_t> part_of;    // part number of each triangle
  double off_by_m = 0;                   // metres; proved (surface_distance.hpp)

  std::uint64_t bytes() const;
};

/// Returns the part number of each triangle.
std::vector<std::uint32_t> parts_of_triangles(const std::vector<Part>& parts, std::size_t triangle_count);

/// Returns the triangle numbers at which parts end, in the form that simplify takes.
std::vector<std::uint32_t> ends_of_parts(const std::vector<Part>& parts);

/// Builds levels, finest first, each with a quarter of the triangles of the level before and a measured bound. Stops
/// when no more edges can be collapsed, or when a level would be off by a sixteenth of the mesh's size.
/// cost  per level a few microseconds per triangle of the mesh, on all cores
std::vector<std::shared_ptr<const SceneLevel>> build_levels(const TriangleMesh& mesh, const Bvh& tree,
                                                            const std::vector<Part>& parts, const CollapseOrder& order,
                                                            const std::function<bool()>& cancelled);

/// The coarsest level that is off by at most error_m; null if there is none.
const SceneLevel* coarsest_within(const std::vector<std::shared_ptr<const SceneLevel>>& levels, double error_m);

}  // namespace collided::engine
