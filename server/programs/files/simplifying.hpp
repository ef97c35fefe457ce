#pragma once

#include <string>

#include "server/intake/scene.hpp"
#include "server/intake/simplify/simplify.hpp"

namespace collided::engine::files {

/// Puts a simpler mesh in the place of the scene's, and says by how much it is off. Parts keep their names; triangles get
/// new numbers.
/// target  "5000" triangles, or "10%" of them; throws LoadError for any other text
void simplify_to(Scene& scene, const std::string& target, CollapseCost cost);

/// Adds the order in which the mesh is simplified, for levels of detail, and says what levels it gives.
void add_levels(Scene& scene, CollapseCost cost);

}  // namespace collided::engine::files
