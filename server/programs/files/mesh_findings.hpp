#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/scene.hpp"
#include "server/world/objects/self_intersections.hpp"

namespace collided::engine::files {

/// A mesh of a file, with its findings.
struct CheckedMesh {
  std::string name;
  const TriangleMesh* mesh = nullptr;
  const std::vector<Part>* parts = nullptr;  // of the scene; null: the mesh is one object's
  CutTriangles cut{};                        // of an object's mesh: from its triangles to those of the file
  MeshHealth health;
  SelfIntersections crossings;
  std::uint64_t crease_edge_count = 0;
  std::uint64_t material_edge_count = 0;                 // edges between two parts
  std::optional<std::uint64_t> silhouette_edge_count{};  // seen from the eye; nothing without one
};

/// What to look for in a mesh.
struct Scrutiny {
  double crack_m = 0;         // widest crack to look for; 0: a share of the diagonal
  double crease_deg = 30;     // angle between two triangles above which their edge is a crease
  std::optional<Vec3> eye{};  // from which silhouette edges are counted
};

/// Examines a mesh: its edges, its seams, and where its triangles meet each other. mesh and parts must outlive the
/// result.
///
/// progress  called with the fraction done in [0, 1], from any thread
/// throws    Interrupted
CheckedMesh check_mesh(std::string name, const TriangleMesh& mesh, const std::vector<Part>* parts,
                       const Scrutiny& scrutiny, const std::function<void(double)>& progress);

/// A triangle as named in answers.
struct NamedTriangle {
  std::string object;
  std::uint32_t triangle = 0;
};

/// Where a finding is: a triangle; in `detail` a side or a point, if there is one; and the other triangle of an
/// intersection.
struct FindingPlace {
  std::string object;
  std::uint32_t triangle = 0;
  std::string detail;
  std::optional<NamedTriangle> with{};
};

/// One kind of fault of a mesh.
struct MeshFinding {
  const char* key;   // its name in JSON
  const char* what;  // its name in the table
  std::uint64_t count = 0;
  std::vector<FindingPlace> worst;  // worst first
  std::string consequence;          // how the service handles it
};

/// The faults that the mesh has, in a fixed order, each with at most worst_count places.
std::vector<MeshFinding> findings_of(const CheckedMesh& checked, std::size_t worst_count);

/// The same findings, those that spoil answers first and common ones last.
std::vector<MeshFinding> by_weight(std::vector<MeshFinding> findings);

}  // namespace collided::engine::files
