#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "server/intake/scene.hpp"

namespace collided::engine {

/// What mending did. Numbers of points count places, not the vertices there.
struct MendReport {
  std::uint64_t t_vertex_count = 0;      // edges cut at a point that lay on them
  std::uint64_t cut_triangle_count = 0;  // triangles that became several
  std::uint64_t joined_point_count = 0;  // points moved onto the one beside them
  std::uint64_t closed_edge_count = 0;   // edges bent to a point beside them
  double largest_move_m = 0;             // how far a point or an edge went at most
  double crack_m = 0;                    // the widest crack that was to be closed
  std::uint64_t unseen_point_count = 0;  // of the border, not looked at after kMaxSeamTests
  std::uint64_t boundary_edges_before = 0;
  std::uint64_t boundary_edges_after = 0;

  bool did_anything() const { return cut_triangle_count + joined_point_count > 0; }
};

/// A mended mesh: triangle i is (a piece of) triangle origin[i] of the one that came; as many as came keep their
/// places.
struct MendedMesh {
  TriangleMesh mesh;
  std::vector<std::uint32_t> origin;
  MendReport report;
};

/// Makes triangles along each other's borders share their points: points beside each other become one (the first), and
/// a triangle is cut where another one's point is on its edge or beside it. Nothing is filled, dropped or turned over.
///
/// crack_m   the widest crack to close; 0: kCrackReach of the diagonal. What counts as a crack: find_seams
/// promise   where all that was found are T-vertices, no vertex moves: the area is the same but for their rounding; no
///           point moves by more than crack_m
/// cost      that of finding seams, once for each round; three rounds are usual
MendedMesh mend(TriangleMesh mesh, double crack_m);

/// The same for a scene's static mesh, whose parts then tell of the pieces (CutTriangles).
MendReport mend(Scene& scene, double crack_m);
std::vector<std::string> sentences(const MendReport& report);

/// The same for the meshes of the scene's objects, each by itself and once where several share it.
///
/// returns   sentences for the user, each with the name of the object; nothing where no object has a mesh
std::vector<std::string> mend_objects(Scene& scene, double crack_m);

}  // namespace collided::engine
