#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// A mesh with its index, and a number for each triangle: the part of the surface that it belongs to.
struct PartedSurface {
  const TriangleMesh& mesh;
  const Bvh& tree;
  std::span<const std::uint32_t> part_of;
};

struct DistanceOptions {
  std::size_t pieces_at_most = 200'000;  // triangles may be cut into so many; with fewer the bound holds too, but is wider
  std::function<bool()> cancelled{};     // true ends it with the bound found so far
};

/// A bound on the distance of any point of either surface to the same part of the other one (Hausdorff distance): no
/// distance to a part of one can differ from the distance to that part of the other by more. Infinite where a part has
/// triangles in one of them only.
///
/// cost     some microseconds a triangle, on all cores
/// threads  any; runs its own
/// source   sheets over tables (surface_cover.hpp) for most triangles; the others are cut until no piece can be farther
///          than a distance that does occur: Cignoni, Rocchini, Scopigno, "Metro", 1998, with bounds in place of samples
double surface_distance(const PartedSurface& a, const PartedSurface& b, const DistanceOptions& options = {});

}  // namespace collided::engine
