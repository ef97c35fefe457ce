#pragma once

#include <string>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// A warning sentence if a mesh is far from the origin and all its numbers are single precision, else nothing. Its
/// points were rounded to a grid coarser than kCoarseGrid_m before the file was written, and no reader can restore
/// them.
///
/// mesh      as in the file, not yet scaled
/// unit_m    metres per unit of the file
std::string single_precision_warning(const TriangleMesh& mesh, double unit_m);

}  // namespace collided::engine
