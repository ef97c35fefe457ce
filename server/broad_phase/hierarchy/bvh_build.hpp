#pragma once

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine::bvh {

/// Builds the tree over all triangles of the mesh; an empty layout if there are none or the caller cancelled.
/// Fills depth, nodes, leaves, references and bytes of the report.
Layout build_layout(const TriangleMesh& mesh, const BvhOptions& options, BvhReport& report);

}  // namespace collided::engine::bvh
