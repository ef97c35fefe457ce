#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "server/intake/simplify/collapse_order.hpp"

namespace collided::engine {

/// What a collapse costs: the cheapest is taken first.
enum class CollapseCost {
  edge_length,  // how far the vertex goes
  quadric,      // how far it ends from the planes that it stands for
};

struct SimplifyOptions {
  CollapseCost cost = CollapseCost::quadric;
  std::size_t triangles_at_most = 0;           // ends there; 0: goes on as long as the guards let it
  std::span<const std::uint32_t> part_ends{};  // triangle numbers at which parts end, ascending; empty: one part
  std::function<void(double)> progress{};      // fraction done in [0, 1]
  std::function<bool()> cancelled{};           // true ends it with what has been found
};

/// What the guards refused; one vertex may be refused again whenever its neighbourhood has changed.
struct SimplifyReport {
  std::size_t triangle_count = 0;  // that are left
  std::uint64_t topology_refusals = 0;
  std::uint64_t flip_refusals = 0;
  std::uint64_t crossing_refusals = 0;
};

/// Simplifies a mesh by collapsing edges towards one of their ends, so that vertices never move, and says in which order.
///
/// promise   no triangle's normal turns by 90 degrees or more from what it was in the mesh; no two triangles that are left
///           meet beyond common corners and edges unless they did before (exact signs; in doubt a collapse is refused);
///           holes, pieces and borders stay, vertices of two parts and each part's last triangle too. Vertices with equal coordinates count as one.
/// cost      O(n log n), about 10 us a collapse
/// threads   pure, the calling one alone; same input, same order
/// source    Hoppe, "Progressive Meshes", 1996; Garland, Heckbert, "Surface Simplification Using Quadric Error
///           Metrics", 1997
CollapseOrder simplify(const TriangleMesh& mesh, const SimplifyOptions& options, SimplifyReport& report);

}  // namespace collided::engine
