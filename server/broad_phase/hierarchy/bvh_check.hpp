#pragma once

#include <string>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine::bvh {

/// Whether a tree of unknown origin is one that a build could have made of the mesh, as far as answers and safety go:
/// every reference leads forward to a node or leaf of its own, no path is deeper than the walks' stacks, every box
/// contains what lies below it, every triangle is in a leaf with its own corners or covered by boxes that are, and
/// every order names each child once. What is left unchecked is how good the cuts are.
///
/// layout    frame and has_corners are the mesh's own already
/// report    depth, nodes, leaves, references and bytes are filled in
/// returns   what is wrong, or nothing
/// cost      linear in nodes, leaves and triangles; the leaves on several threads
/// tests     BroadTampered, fuzz_saved_index
std::string flaw_of(const Layout& layout, const TriangleMesh& mesh, unsigned threads, BvhReport& report);

}  // namespace collided::engine::bvh
