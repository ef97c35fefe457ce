#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/edge_table.hpp"
#include "server/intake/limits.hpp"

namespace collided::engine {

/// A place at which two sections of a mesh's border run along each other without sharing a point.
struct Seam {
  enum class Kind : std::uint8_t {
    t_vertex,     // the point lies on the edge, to kOnEdge roundings
    beside_edge,  // a crack: the point is beside the edge
    beside_point  // a crack: the point is beside another point
  };
  Kind kind = Kind::t_vertex;
  std::uint32_t point = 0;        // a vertex number
  std::uint32_t other_point = 0;  // for beside_point only
  HalfEdge edge = 0;  // the side that the point should be on; for beside_point, a side that ends at other_point
  double gap_m = 0;   // distance from the point to the edge or the other point
};

/// The distances in a search for seams.
struct SeamReach {
  double on_edge_m = 0;  // a point this near to an edge counts as on it
  double crack_m = 0;    // the widest crack
  std::uint64_t max_tests = kMaxSeamTests;
};

/// The reach for a mesh with those bounds, from kOnEdge and kCrackReach; crack_m as given if it is not 0.
SeamReach seam_reach(const TriangleMesh& mesh, const Aabb& bounds, double crack_m);

/// The seams of a mesh.
struct Seams {
  std::vector<Seam> list;
  std::uint64_t unseen_count = 0;  // points of the border not examined, because max_tests was reached
};

/// Finds every T-vertex and crack along the border, which is the edges of one triangle; ordered by point. Two points
/// beside each other are reported once. A gap counts as a crack if it is at most crack_m, and at most kCrackShare of
/// the shortest edge at the point (and at the other point; beside an edge also of its triangle's height): anything
/// finer is taken for detail of the surface.
///
/// table     with equal points joined and triangles without area left out
/// point_of  that the table was made with
/// error     gaps are exact to a few roundings of the largest coordinate
/// cost      about 2 us per edge of one triangle; nothing if there is none
Seams find_seams(const TriangleMesh& mesh, const EdgeTable& table, const std::vector<std::uint32_t>& point_of,
                 const SeamReach& reach, const Aabb& bounds);

}  // namespace collided::engine
