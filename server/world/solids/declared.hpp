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
  std::shared_ptr<const SolidMesh> solid;      // null: it bounds no solid
  std::shared_ptr<const WindingMesh> winding;  // set if it bounds no solid, and may be solid by its winding number
  std::string refusal;                         // why it bounds no solid, as a whole clause; empty: it does
  std::string warning;                         // why the solid is not exactly what the mesh borders; empty: it is
};

/// Declares one mesh solid while others wait for it: leaves out what would take longer than 200 ms of the search for
/// crossing triangles, and of building the tree.
DeclaredMesh declare_solid_at_once(const std::shared_ptr<const TriangleMesh>& mesh, SolidBy by = SolidBy::closing);

/// Result of declaring the meshes of a scene solid. Each line is a sentence for the user.
struct DeclaredSolids {
  std::size_t count = 0;
  std::size_t by_winding = 0;         // others, which are open
  std::vector<std::string> refused;   // meshes that bound no solid, and stay surfaces
  std::vector<std::string> warnings;  // meshes that are more than a border
};

/// Declares the parts and objects solid that have a mesh, and a name that matches the glob or a file that declares them.
///
/// by         for those with a matching name; a file declares its own
/// scene      as World::index_scene gave it, with its geometry
/// cancelled  called now and then; true ends the work
/// cost       that of solid_within for each; one copy of the triangles of each part
DeclaredSolids declare_solids(const Scene& scene, StaticScene& geometry, std::string_view glob,
                              const std::function<bool()>& cancelled = {}, SolidBy by = SolidBy::closing);

}  // namespace collided::engine
