#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/geometry/edge_table.hpp"

namespace collided::engine {

/// Kinds of edges, as bits; an edge may be of several.
enum EdgeKind : std::uint8_t {
  kBoundaryEdge = 1,     // edge of one triangle only
  kManyEdge = 2,         // of three or more
  kCreaseEdge = 4,       // of two that meet at more than the given angle
  kMaterialEdge = 8,     // of triangles with different materials
  kSilhouetteEdge = 16,  // of two, one of which faces the eye and the other does not
};

/// Input for creases, material edges and silhouettes.
struct EdgeView {
  /// An edge is a crease if the cosine of the angle between its two normals is below this, in [-1, 1]; used exactly as
  /// given.
  double crease_cosine = 0.5;
  std::span<const std::uint32_t> material{};  // one per triangle; empty: all have the same
  std::optional<Vec3> eye{};                  // viewpoint for silhouettes; none: no silhouettes
};

/// The kinds of every edge of the table, in the table's order.
///
/// Decided exactly for the given doubles: the crease by the product of the normals against the cosine times their
/// lengths, squared; the silhouette by the side of each plane that the eye is on. A triangle that the eye sees edge-on
/// does not face it, so that on a closed mesh silhouettes are loops: an even number meets at each point. If two
/// triangles run along their edge in the same direction, one of them counts as flipped. The table should leave out
/// triangles without area.
///
/// cost      about 60 ns per edge for creases, 25 per triangle for silhouettes; allocates the result
/// threads   pure
std::vector<std::uint8_t> edge_kinds(const TriangleMesh& mesh, const EdgeTable& table, const EdgeView& view);

}  // namespace collided::engine
