#pragma once

#include <memory>
#include <span>

#include "server/world/objects/object.hpp"

namespace collided::engine {

/// Many primitives of one object with an index over their bounds, in the object's frame; candidates are their numbers.
/// Only walk_box may be asked of the tree: its other walks look at triangles, and here there are none.
struct IndexedParts {
  Bvh tree;
  double radius_m = 0;  // no point of any is farther from the frame's origin
};

/// Null for so few that asking each is cheaper, and where one is of a kind whose place turns it by more than rounding (a
/// short cylinder far out), which the walks' slack does not cover.
/// cost  10 ms for 100,000
std::shared_ptr<const IndexedParts> index_parts(std::span<const Primitive> parts);

}  // namespace collided::engine
