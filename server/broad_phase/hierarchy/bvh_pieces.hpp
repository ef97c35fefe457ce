#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/broad_phase/hierarchy/bvh_primitive.hpp"

namespace collided::engine::bvh {

/// Clipped splits: a long, slanted triangle enters the build as several boxes that together cover it, each around a
/// part of it, so that one large box does not enlarge every node above it.
///
/// source  Karras, Aila, "Fast Parallel Construction of High-Quality Bounding Volume Hierarchies", 2013, section 5

inline constexpr std::uint32_t kMaxPieces = 64;

/// Boxes in local coordinates that cover the triangle, each with its number; determined by mesh, frame and count alone.
/// Cuts in half at planes perpendicular to the longest side until there are `count` (1 to kMaxPieces) or a side is too
/// short.
/// returns  the number written
std::uint32_t cover(const TriangleMesh& mesh, const LocalFrame& frame, std::uint32_t number, std::uint32_t count,
                    std::span<Primitive> pieces);

/// The triangles worth splitting, ascending; none if splitting does not pay. whole: the box of each triangle.
std::vector<Split> worth_splitting(const TriangleMesh& mesh, const LocalFrame& frame, std::span<const Primitive> whole,
                                   unsigned threads);

}  // namespace collided::engine::bvh
