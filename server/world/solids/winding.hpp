#pragma once

#include <memory>

#include "server/exact_phase/solid/winding_tree.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// An open mesh, and what it holds by its winding number, in its own frame. Used only by `inside` and signed near: no
/// surface bounds the region across its holes, so everything else treats it as a surface.
struct WindingMesh {
  std::shared_ptr<const IndexedMesh> surface;
  WindingTree tree;
};

/// cost  2 to 3 us a triangle; a copy of the triangles
std::shared_ptr<const WindingMesh> winding_within(std::shared_ptr<const IndexedMesh> surface);

/// The side of a world point, for the pose given; undecided if rounding leaves it open.
/// cost  microseconds; more near holes
WindingSide side_by_winding(const WindingMesh& mesh, const Placed& object, const Vec3& point, WalkCost& cost);

/// Finds the side by summing every triangle, for audits.
WindingSide side_by_winding_sum(const WindingMesh& mesh, const Placed& object, const Vec3& point);

}  // namespace collided::engine
