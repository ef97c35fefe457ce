#pragma once

#include <string>

#include "server/geometry/mesh.hpp"

namespace collided::engine {

/// A sentence of warning when a mesh far from the origin carries nothing but single-precision numbers, else nothing:
/// its points were rounded to a grid that is coarser than kCoarseGrid_m before the file was written, and no reader
/// can bring them back.
///
/// mesh      as the file has it, not yet scaled
/// unit_m    metres per unit of the file
std::string single_precision_warning(const TriangleMesh& mesh, double unit_m);

}  // namespace collided::engine
