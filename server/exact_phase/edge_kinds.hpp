#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "server/geometry/edge_table.hpp"

namespace collided::engine {

/// What an edge is; one may be several of these.
enum EdgeKind : std::uint8_t {
  kBoundaryEdge = 1,     // of one triangle only
  kManyEdge = 2,         // of three and more
  kCreaseEdge = 4,       // of two that meet at more than the asked angle
  kMaterialEdge = 8,     // of triangles of different materials
  kSilhouetteEdge = 16,  // of two, one of which faces the eye and the other does not
};

struct EdgeView {
  /// Cosine of the angle between the normals of two triangles above which their edge is a crease: as given, in [-1, 1].
  double crease_cosine = 0.5;
  std::span<const std::uint32_t> material{};  // one a triangle; empty: all are of one
  std::optional<Vec3> eye{};                  // none: no silhouettes
};

/// The kinds of every edge of the table, in its order.
///
/// Decided exactly for the given doubles: the crease by normals . normals against the cosine times their lengths,
/// squared; the silhouette by the sides of the eye. A triangle that the eye sees edge-on does not face it, so that on a
/// closed mesh silhouettes are loops: an even number of them meets at each point. Where two triangles run along their
/// edge the same way, one of them counts as turned over. Triangles without area belong left out of the table.
///
/// cost      about 60 ns an edge for creases, 25 a triangle for silhouettes; allocates the result
/// threads   pure
std::vector<std::uint8_t> edge_kinds(const TriangleMesh& mesh, const EdgeTable& table, const EdgeView& view);

}  // namespace collided::engine
