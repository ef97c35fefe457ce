#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "server/intake/mesh/mesh_health.hpp"
#include "server/intake/scene.hpp"
#include "server/world/objects/self_intersections.hpp"

namespace collided::engine::files {

/// A mesh of a file with what was found out about it.
struct CheckedMesh {
  std::string name;
  const TriangleMesh* mesh = nullptr;
  const std::vector<Part>* parts = nullptr;  // null: the mesh is one object's
  CutTriangles cut{};                        // of an object's mesh
  MeshHealth health;
  SelfIntersections crossings;
  std::uint64_t crease_edge_count = 0;
  std::uint64_t material_edge_count = 0;                 // between parts
  std::optional<std::uint64_t> silhouette_edge_count{};  // seen from the eye
};

/// How meshes are looked at.
struct Scrutiny {
  double crack_m = 0;
  double crease_deg = 30;
  std::optional<Vec3> eye{};
};

/// progress  told the fraction done in [0, 1], from any thread
/// throws    Interrupted
CheckedMesh check_mesh(std::string name, const TriangleMesh& mesh, const std::vector<Part>* parts,
                       const Scrutiny& scrutiny, const std::function<void(double)>& progress);

/// A triangle as answers name it, with a side or another triangle where the finding has one, and how bad it is.
struct Place {
  std::string object;
  std::uint32_t triangle = 0;
  std::string detail;
};

/// One kind of what is wrong.
struct Finding {
  const char* key;   // in JSON
  const char* what;  // in the table
  std::uint64_t count = 0;
  std::vector<Place> worst;  // worst first
  std::string consequence;   // what the service does about it
};

/// Those of which there are any, in a fixed order. worst_count: at most so many places of each.
std::vector<Finding> findings_of(const CheckedMesh& checked, std::size_t worst_count);

}  // namespace collided::engine::files
