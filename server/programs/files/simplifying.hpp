#pragma once

#include <string>

#include "server/intake/scene.hpp"
#include "server/intake/simplify/simplify.hpp"

namespace collided::engine::files {

/// Replaces the scene's mesh by a simpler one, and prints the distance of their surfaces. Parts keep their names, but
/// one without a triangle left is removed; triangles get new numbers.
///
/// target  "5000" triangles, or "10%" of them; throws LoadError for any other text
void simplify_to(Scene& scene, const std::string& target, CollapseCost cost);

/// Adds the order in which the mesh is simplified, from which loading makes levels of detail, and prints these levels.
void add_levels(Scene& scene, CollapseCost cost);

}  // namespace collided::engine::files
