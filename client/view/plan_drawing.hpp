#pragma once

#include <string>

#include "collided/client.hpp"

namespace collided::view {

/// A plan from above as SVG: for browsers without WebGL. Meshes by their edges (of at most 20,000 triangles, evenly chosen),
/// the other shapes by their outlines from above; half-spaces are left out. Pure.
std::string plan_svg(const ShownObjects& shown, bool y_is_up);

}  // namespace collided::view
