#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// Result of mending. Vertices with equal coordinates count as one point.
struct MendReport {
  std::uint64_t t_vertex_count = 0;      // edges cut at a point that lies on them
  std::uint64_t cut_triangle_count = 0;  // triangles cut into several
  std::uint64_t joined_point_count = 0;  // points moved onto a point beside them
  std::uint64_t closed_edge_count = 0;   // edges bent to a point beside them
  double largest_move_m = 0;             // the farthest that a point or an edge was moved
  double crack_m = 0;                    // the widest crack that was closed
  std::uint64_t unseen_point_count = 0;  // points of the border not examined, because kMaxSeamTests was reached
  std::uint64_t boundary_edges_before = 0;
  std::uint64_t boundary_edges_after = 0;

  bool did_anything() const { return cut_triangle_count + joined_point_count > 0; }
};

/// A mended mesh. Triangle i is triangle origin[i] of the given mesh or a piece of it. The first piece of each triangle
/// keeps its number; further pieces come last.
struct MendedMesh {
  TriangleMesh mesh;
  std::vector<std::uint32_t> origin;
  MendReport report;
};

/// Makes triangles along each other's borders share their points: nearby points all move to the first of them, and a
/// triangle is cut if a point of another one is on its edge or beside it. Holes are not filled, and no triangle is
/// dropped or turned over.
///
/// crack_m   the widest crack to close; 0: kCrackReach times the diagonal. find_seams defines cracks
/// promise   no point moves by more than crack_m. If only T-vertices are found no vertex moves, and the surface is the
///           same except for their rounding
/// cost      that of finding seams, once for each round; three rounds are usual
MendedMesh mend(TriangleMesh mesh, double crack_m);

/// Mends a scene's static mesh. Its parts then have the origin of the pieces (CutTriangles).
MendReport mend(Scene& scene, double crack_m);
/// The result of mending, as sentences for the user.
std::vector<std::string> sentences(const MendReport& report);

/// Mends the meshes of the scene's objects, each separately and once if several share it.
///
/// returns   sentences for the user, each with the name of the object; nothing if no object has a mesh
std::vector<std::string> mend_objects(Scene& scene, double crack_m);

}  // namespace collided::engine
