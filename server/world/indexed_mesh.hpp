#pragma once

#include <memory>

#include "server/world/object.hpp"

namespace collided {

/// A mesh and the tree that was built of it, as objects share them.
std::shared_ptr<const IndexedMesh> indexed_mesh(std::shared_ptr<const TriangleMesh> mesh, BspTree tree);

}  // namespace collided
