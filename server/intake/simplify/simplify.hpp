#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "server/intake/simplify/collapse_order.hpp"

namespace collided::engine {

/// How the cost of a collapse is measured; the cheapest collapse comes first.
enum class CollapseCost {
  edge_length,  // the distance between the two vertices
  quadric,      // how far the remaining vertex is from the planes of the triangles merged into it
};

/// The goal of simplification, and the caller's control over it.
struct SimplifyOptions {
  CollapseCost cost = CollapseCost::quadric;
  std::size_t triangles_at_most = 0;           // stop here; 0: continue until the guards refuse every collapse
  std::span<const std::uint32_t> part_ends{};  // triangle numbers at which parts end, ascending; empty: one part
  std::function<void(double)> progress{};      // called with the fraction done, in [0, 1]
  std::function<bool()> cancelled{};           // true ends it with the collapses found so far
};

/// The remaining triangles, and how many collapses each guard refused. A vertex may be refused again whenever its
/// neighbourhood has changed.
struct SimplifyReport {
  std::size_t triangle_count = 0;  // of the simplest level
  std::uint64_t topology_refusals = 0;
  std::uint64_t flip_refusals = 0;
  std::uint64_t crossing_refusals = 0;
};

/// Simplifies a mesh by collapsing edges to one of their ends, so that vertices never move. Returns the order of the
/// collapses, from which any level of detail can be made.
///
/// promise   no triangle's normal turns by 90 degrees or more from the original; no two triangles that remain meet
///           beyond common corners and edges unless they did before (signs are exact; in doubt a collapse is refused);
///           holes, pieces and borders stay, and so do vertices that belong to two parts and each part's last triangle.
///           Vertices with equal coordinates count as one
/// cost      O(n log n), about 10 us per collapse
/// threads   pure, on the calling thread only; the same input gives the same order
/// source    Hoppe, "Progressive Meshes", 1996; Garland, Heckbert, "Surface Simplification Using Quadric Error
///           Metrics", 1997
CollapseOrder simplify(const TriangleMesh& mesh, const SimplifyOptions& options, SimplifyReport& report);

}  // namespace collided::engine
