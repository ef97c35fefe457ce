#pragma once

#include <memory>

#include "server/exact_phase/solid/winding_tree.hpp"
#include "server/world/objects/contact_search.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// A mesh that does not close, and what it holds by its winding number, in its own frame. Only `inside` and signed near
/// ask it: no surface bounds what lies across its holes, so to all else it stays a surface.
struct WindingMesh {
  std::shared_ptr<const IndexedMesh> surface;
  WindingTree tree;
};

/// cost  2 to 3 us a triangle; a copy of the triangles
std::shared_ptr<const WindingMesh> winding_within(std::shared_ptr<const IndexedMesh> surface);

/// Where a point of the world is, for the pose given; undecided where its rounding leaves that open.
/// cost  microseconds; more about holes
WindingSide side_by_winding(const WindingMesh& mesh, const Placed& object, const Vec3& point, WalkCost& cost);

/// The same by every triangle on its own, for audits.
WindingSide side_by_winding_sum(const WindingMesh& mesh, const Placed& object, const Vec3& point);

}  // namespace collided::engine
