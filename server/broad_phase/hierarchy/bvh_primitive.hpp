#pragma once

#include <cstdint>

#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/broad_phase/hierarchy/bvh_split.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine::bvh {

/// What the tree says of one triangle, as a function of the mesh and the frame alone: the build writes it, the check
/// of a saved tree computes it again.

/// Bounds in local coordinates, rounded outward.
Primitive local_primitive(const TriangleMesh& mesh, const LocalFrame& frame, std::uint32_t number);

/// Writes the triangle into a lane of a leaf.
void set_lane(const TriangleMesh& mesh, const LocalFrame& frame, bool has_corners, std::uint32_t number, int lane,
              Leaf& leaf);

/// What all triangles have in common. bounds: of every vertex that a triangle has.
struct MeshFrame {
  LocalFrame frame;
  bool has_corners = false;  // every corner of a triangle is a float in the frame
};
MeshFrame mesh_frame(const TriangleMesh& mesh, unsigned threads);

}  // namespace collided::engine::bvh
