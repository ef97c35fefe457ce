#pragma once

#include <memory>
#include <span>

#include "server/world/objects/object.hpp"

namespace collided::engine {

/// Many primitives of one object with an index over their bounds, in the object's frame; candidates are numbers of
/// primitives.
/// Always: only walk_box may be called on the tree; the other walks read triangles, and here there are none.
struct IndexedParts {
  Bvh tree;
  double radius_m = 0;  // largest distance of a point of any primitive from the frame's origin
};

/// Indexes the primitives. Null if testing each is cheaper, or if placing one errs by more than rounding (a short
/// cylinder far out), which the slack of the walks does not cover.
/// cost  10 ms for 100,000
std::shared_ptr<const IndexedParts> index_parts(std::span<const Primitive> parts);

}  // namespace collided::engine
