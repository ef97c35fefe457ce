#pragma once

#include "server/broad_phase/bsp_layout.hpp"
#include "server/broad_phase/bsp_tree.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine::bsp {

/// The tree over all triangles of the mesh; an empty layout if there are none or the caller cancelled.
/// Fills depth, nodes, leaves, references and bytes of the report.
Layout build_layout(const TriangleMesh& mesh, const BspOptions& options, BspReport& report);

}  // namespace collided::engine::bsp
