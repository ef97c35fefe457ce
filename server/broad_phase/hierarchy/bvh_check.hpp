#pragma once

#include <string>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine::bvh {

/// Checks that a tree of unknown origin is one that a build could have made of the mesh, as far as answers and safety
/// depend on it: every reference leads forward to a node or leaf of its own, no path is deeper than the walks' stacks,
/// every box contains its descendants, every triangle is in a leaf with its own corners or covered by boxes of leaves
/// that hold it, and every order names each child once. Does not check the quality of the cuts.
///
/// layout    frame and has_corners must be the mesh's own already
/// report    receives depth, nodes, leaves, references and bytes
/// returns   the flaw; empty if there is none
/// cost      linear in nodes, leaves and triangles; the leaves on several threads
/// tests     BroadTampered, fuzz_saved_index
std::string flaw_of(const Layout& layout, const TriangleMesh& mesh, unsigned threads, BvhReport& report);

}  // namespace collided::engine::bvh
