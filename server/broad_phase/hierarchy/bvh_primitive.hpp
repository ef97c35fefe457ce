#pragma once

#include <cstdint>

#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/broad_phase/hierarchy/bvh_split.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine::bvh {

/// What the tree stores about one triangle, a function of mesh and frame alone: the build writes it, and the check of a
/// saved tree computes it again.

/// The triangle's bounds in local coordinates, rounded outward, with its number.
Primitive local_primitive(const TriangleMesh& mesh, const LocalFrame& frame, std::uint32_t number);

/// Writes the triangle into a lane of a leaf.
void set_lane(const TriangleMesh& mesh, const LocalFrame& frame, bool has_corners, std::uint32_t number, int lane,
              Leaf& leaf);

/// The local frame of all triangles: from the bounds of every vertex that a triangle uses.
struct MeshFrame {
  LocalFrame frame;
  bool has_corners = false;  // every corner of a triangle is a float in the frame
};
MeshFrame mesh_frame(const TriangleMesh& mesh, unsigned threads);

}  // namespace collided::engine::bvh
