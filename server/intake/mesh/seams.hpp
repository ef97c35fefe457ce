#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/edge_table.hpp"
#include "server/intake/limits.hpp"

namespace collided::engine {

/// A place where the border of a mesh runs along its border without sharing points.
struct Seam {
  enum class Kind : std::uint8_t {
    t_vertex,     // the point lies on the edge, to kOnEdge roundings
    beside_edge,  // a crack: beside the edge
    beside_point  // a crack: beside another point
  };
  Kind kind = Kind::t_vertex;
  std::uint32_t point = 0;        // a vertex number
  std::uint32_t other_point = 0;  // beside_point only
  HalfEdge edge = 0;  // the triangle's side that the point should be on; of beside_point, one that ends there
  double gap_m = 0;
};

struct SeamReach {
  double on_edge_m = 0;
  double crack_m = 0;
  std::uint64_t max_tests = kMaxSeamTests;
};

/// kOnEdge and kCrackReach of a mesh with those bounds; crack_m as asked where that is not 0.
SeamReach seam_reach(const TriangleMesh& mesh, const Aabb& bounds, double crack_m);

struct Seams {
  std::vector<Seam> list;
  std::uint64_t unseen_count = 0;  // points of the border that were not looked at, after so many tests
};

/// Every T-vertex and crack along the edges of one triangle, ordered by point; a point beside a point is told once of
/// the two. A point counts where the gap is at most crack_m and kCrackShare of the shortest edge there (both points',
/// for an edge also of the height of its triangle): what is finer is detail.
///
/// table     with equal points joined, triangles without area left out
/// point_of  as the table was made with
/// error     gaps are right to some roundings of the largest coordinate
/// cost      about 2 us an edge of one triangle; nothing where there is none
Seams find_seams(const TriangleMesh& mesh, const EdgeTable& table, const std::vector<std::uint32_t>& point_of,
                 const SeamReach& reach, const Aabb& bounds);

}  // namespace collided::engine
