#pragma once

#include <memory>

#include "server/geometry/shape.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// A mesh with the index that was built of it.
std::shared_ptr<const IndexedMesh> indexed_mesh(std::shared_ptr<const TriangleMesh> mesh, Bvh tree);

/// A shape that is in no world, as an object without name or place; its mesh is indexed by the calling thread.
ObjectInfo without_world(const Shape& shape);

}  // namespace collided::engine
