#pragma once

#include <string>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine::bvh {

/// Checks that a tree of unknown origin is one that a build could have made of the mesh, as far as answers and safety
/// depend on it: every reference leads forward to a node or leaf of its own, no path is deeper than the walks' stacks,
/// every box contains what lies below it, every triangle is in a leaf with its own corners or covered by boxes of
/// leaves that hold it, and every order names each child once. Does not check how good the cuts are.
///
/// layout    frame and has_corners must be the mesh's own already
/// report    receives depth, nodes, leaves, references and bytes
/// returns   what is wrong; empty: nothing
/// cost      linear in nodes, leaves and triangles; the leaves on several threads
/// tests     BroadTampered, fuzz_saved_index
std::string flaw_of(const Layout& layout, const TriangleMesh& mesh, unsigned threads, BvhReport& report);

}  // namespace collided::engine::bvh
