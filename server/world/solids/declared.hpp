#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "server/intake/scene.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// A mesh declared solid.
struct DeclaredMesh {
  std::shared_ptr<const IndexedMesh> indexed;
  std::shared_ptr<const SolidMesh> solid;      // null: it bounds none
  std::shared_ptr<const WindingMesh> winding;  // where it bounds none and may be solid by its winding number
  std::string refusal;                         // why it bounds none, as a whole clause; empty: it is one
  std::string warning;                         // what makes it more than a border, or less; empty: nothing does
};

/// Declares one mesh solid while others wait for it: what takes longer than 200 ms of the search for triangles that cross,
/// and of the tree, is left out.
DeclaredMesh declare_solid_at_once(const std::shared_ptr<const TriangleMesh>& mesh, SolidBy by = SolidBy::closing);

/// What came of declaring the meshes of a scene solid. Each line is a sentence for the user.
struct DeclaredSolids {
  std::size_t count = 0;
  std::size_t by_winding = 0;         // others, that do not close
  std::vector<std::string> refused;   // meshes that bound no solid and stay surfaces
  std::vector<std::string> warnings;  // meshes that are more than a border
};

/// Declares those parts and objects solid that have a mesh, and whose names match the glob or whose file declares them.
///
/// by         of those whose names match; a file says it of its own
/// scene      as World::index_scene gave it, with its geometry
/// cancelled  called now and then; true ends the work
/// cost       that of solid_within for each; one copy of the triangles of each part
DeclaredSolids declare_solids(const Scene& scene, StaticScene& geometry, std::string_view glob,
                              const std::function<bool()>& cancelled = {}, SolidBy by = SolidBy::closing);

}  // namespace collided::engine
