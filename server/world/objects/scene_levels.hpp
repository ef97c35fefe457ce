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

/// A simpler form of a scene's mesh: distances to its parts are those to the scene's, off by off_by_m at most.
struct SceneLevel {
  TriangleMesh mesh;
  Bvh tree;
  std::vector<std::uint32_t> originals;  // numbers of its triangles in the scene's mesh
  std::vector<std::uint32_t> part_of;    // part of each triangle
  double off_by_m = 0;                   // proved (surface_distance.hpp)

  std::uint64_t bytes() const;
};

/// The part of each triangle.
std::vector<std::uint32_t> parts_of_triangles(const std::vector<Part>& parts, std::size_t triangle_count);

/// The numbers at which parts end, as simplify wants them.
std::vector<std::uint32_t> ends_of_parts(const std::vector<Part>& parts);

/// Levels with a quarter of the triangles, a quarter of those and so on, finest first, each with its bound measured. Ends
/// where the collapses do, or where a level would be off by a sixteenth of the mesh's size.
/// cost  per level a few microseconds a triangle of the mesh, on all cores
std::vector<std::shared_ptr<const SceneLevel>> build_levels(const TriangleMesh& mesh, const Bvh& tree,
                                                            const std::vector<Part>& parts, const CollapseOrder& order,
                                                            const std::function<bool()>& cancelled);

/// The coarsest level that is off by no more than that; null: none is.
const SceneLevel* coarsest_within(const std::vector<std::shared_ptr<const SceneLevel>>& levels, double error_m);

}  // namespace collided::engine
