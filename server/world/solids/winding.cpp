#include "server/world/solids/winding.hpp"

#include "server/world/solids/solid.hpp"

namespace collided::engine {

std::shared_ptr<const WindingMesh> winding_within(std::shared_ptr<const IndexedMesh> surface) {
  WindingTree tree(*surface->mesh);
  return std::make_shared<WindingMesh>(WindingMesh{.surface = std::move(surface), .tree = std::move(tree)});
}

WindingSide side_by_winding(const WindingMesh& mesh, const Placed& object, const Vec3& point, WalkCost& cost) {
  const PointSeen seen = point_seen_from(object, point, mesh.surface->radius_m);
  return mesh.tree.side(seen.at, seen.slack_m, cost.nodes);
}

WindingSide side_by_winding_sum(const WindingMesh& mesh, const Placed& object, const Vec3& point) {
  const PointSeen seen = point_seen_from(object, point, mesh.surface->radius_m);
  return mesh.tree.side_by_sum(seen.at, seen.slack_m);
}

}  // namespace collided::engine
