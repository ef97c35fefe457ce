#pragma once

#include <functional>
#include <memory>

#include "server/geometry/shape.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// Bundles a mesh with its index, and computes its radius.
std::shared_ptr<const IndexedMesh> indexed_mesh(std::shared_ptr<const TriangleMesh> mesh, Bvh tree);

/// A shape outside of any world, as an object without name or pose.
///
/// cancelled  called now and then; true leaves the index of the mesh empty
/// cost       indexes a mesh on the calling thread
ObjectInfo without_world(const Shape& shape, const std::function<bool()>& cancelled = {});

}  // namespace collided::engine
