#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// A mesh with its index, and the part of the surface to which each triangle belongs.
struct PartedSurface {
  const TriangleMesh& mesh;
  const Bvh& tree;
  std::span<const std::uint32_t> part_of;
};

/// Limits of the refinement in surface_distance().
struct DistanceOptions {
  std::size_t pieces_at_most = 200'000;  // most pieces to cut; a lower limit gives a wider bound
  std::function<bool()> cancelled{};     // true ends the search with the bound found so far
};

/// A bound in metres on the distance of any point of either surface to the same part of the other one (Hausdorff
/// distance): the distance from any point to a part differs by no more between the two surfaces. Infinite if only one
/// of them has triangles of a part.
///
/// cost     some microseconds per triangle, on all cores
/// threads  any; runs threads of its own
/// source   sheets over tables (surface_cover.hpp) for most triangles; cuts the others until no piece can be farther
/// than a distance that does occur: Cignoni, Rocchini, Scopigno, "Metro", 1998, with bounds in place of samples
double surface_distance(const PartedSurface& a, const PartedSurface& b, const DistanceOptions& options = {});

}  // namespace collided::engine
