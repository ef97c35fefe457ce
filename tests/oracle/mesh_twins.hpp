#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "server/geometry/edge_table.hpp"
#include "server/intake/mesh/seams.hpp"
#include "server/world/objects/self_intersections.hpp"

namespace collided::oracle {
using namespace engine;

/// Of each pair of points, lower first, the half-edges between them in ascending order.
using EdgeUses = std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<HalfEdge>>;
EdgeUses edge_uses(const TriangleMesh& mesh, const std::vector<std::uint32_t>& point_of,
                   const std::vector<bool>& left_out);

/// The kinds of one edge by rationals.
std::uint8_t edge_kind(const TriangleMesh& mesh, const std::vector<std::uint32_t>& point_of,
                       const std::vector<HalfEdge>& uses, double crease_cosine, std::span<const std::uint32_t> material,
                       const std::optional<Vec3>& eye);

/// find_seams by all points against all borders.
std::vector<Seam> seams(const TriangleMesh& mesh, const SeamReach& reach);

/// self_intersections by all pairs, in rationals.
std::vector<TrianglePair> self_intersections(const TriangleMesh& mesh);

}  // namespace collided::oracle
