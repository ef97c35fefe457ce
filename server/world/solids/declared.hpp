#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "server/intake/scene.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// What came of declaring the meshes of a scene solid. Each line is a sentence for the user.
struct DeclaredSolids {
  std::size_t count = 0;
  std::vector<std::string> refused;   // meshes that bound no solid and stay surfaces
  std::vector<std::string> warnings;  // meshes that are more than a border
};

/// Declares those parts and objects solid whose names match the glob and that have a mesh.
///
/// scene      as World::index_scene gave it, with its geometry
/// cancelled  called now and then; true ends the work
/// cost       that of solid_within for each; one copy of the triangles of each part
DeclaredSolids declare_solids(const Scene& scene, StaticScene& geometry, std::string_view glob,
                              const std::function<bool()>& cancelled = {});

}  // namespace collided::engine
