// The distance of two separate objects.

#include <limits>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/triangle_depth.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/query/pair_report.hpp"
#include "server/world/query/underflow.hpp"

namespace collided::engine {
namespace {

/// A part to start from; first_bound() improves on it.
ConvexPart any_part(const Placed& object) {
  if (!object.info->primitives.empty()) return place(object.frame, object.info->primitives.front());
  return place(object.frame, object.info->mesh->mesh->triangle(0));
}

/// The mesh's triangle nearest to the point. Alternating between the two objects brings them closer.
std::uint32_t nearest_triangle(const Placed& object, const Vec3& point, WalkCost& cost, Deadline& deadline) {
  const Vec3 local = object.frame.rotation.transpose() * (point - object.frame.position);
  const IndexedMesh& mesh = *object.info->mesh;
  std::uint32_t triangle = 0;
  double best_m2 = std::numeric_limits<double>::infinity();
  const auto candidate = [&](std::uint32_t number, double) {
    if (deadline.is_over()) return -1.0;
    const Closest found = closest(point, place(object.frame, mesh.mesh->triangle(number)));
    const double m2 = found.distance_m * found.distance_m;
    if (m2 < best_m2) {
      best_m2 = m2;
      triangle = number;
    }
    return best_m2 * (1 + kBoundSlack);
  };
  mesh.tree.walk_near(local, std::numeric_limits<double>::infinity(),
                      placement_slack(object.frame, point.lpNorm<1>(), mesh.radius_m), candidate, cost);
  return triangle;
}

/// Two parts whose distance is a good first bound: alternates between the meshes as long as that helps.
Separation first_bound(const Placed& a, const Placed& b, WalkCost& cost, Deadline& deadline) {
  ConvexPart of_a = any_part(a);
  ConvexPart of_b = any_part(b);
  Separation best = separation(of_a, of_b);
  constexpr int kTurns = 6;
  for (int i = 0; i < kTurns; ++i) {
    if (b.info->mesh && b.info->primitives.empty())
      of_b = place(b.frame, b.info->mesh->mesh->triangle(nearest_triangle(b, best.on_a, cost, deadline)));
    if (a.info->mesh && a.info->primitives.empty())
      of_a = place(a.frame, a.info->mesh->mesh->triangle(nearest_triangle(a, best.on_b, cost, deadline)));
    const Separation here = separation(of_a, of_b);
    if (!(here.distance_m < best.distance_m)) break;
    best = here;
  }
  return best;
}

/// The nearest pair so far, and a lower bound on the distance of every tested pair.
struct NearestPair {
  Separation best;
  double low_m;

  void take(const Separation& here) {
    low_m = std::min(low_m, here.distance_m - here.error_m);
    if (here.distance_m < best.distance_m) best = here;
  }
  double reach_m() const { return (best.distance_m + best.error_m) * (1 + kBoundSlack); }
};

/// Two meshes: descends both trees at once.
void search_meshes(const Placed& a, const Placed& b, NearestPair& nearest, WalkCost& cost, Deadline& deadline) {
  PlacedTriangles of_a(*a.info->mesh->mesh, a.frame);
  PlacedTriangles of_b(*b.info->mesh->mesh, b.frame);
  const auto candidate = [&](std::uint32_t triangle_a, std::uint32_t triangle_b, double) {
    if (deadline.is_over()) return -1.0;
    const Triangle& first = of_a.at(triangle_a);
    const Triangle& second = of_b.at(triangle_b);
    // The index rounds corners to floats; doubles rule out most of many almost equally near pairs.
    if (!(kernel::gap_at_least(first, second) > nearest.reach_m())) nearest.take(separation(first, second));
    return nearest.reach_m();
  };
  walk_near_mesh_pairs(
      a, b, nearest.reach_m(), candidate, [&] { return deadline.is_over(); }, cost);
}

}  // namespace

/// Tests all pairs within the best known distance; if a much nearer pair is found, the walk starts again with that
/// distance. Two meshes need no first bound: their walk goes to near triangles first.
Separation distance_between(const Placed& a, const Placed& b, WalkCost& cost, Deadline& deadline) {
  constexpr double kMuchNearer = 0.75;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const bool are_meshes = is_bare_mesh(*a.info) && is_bare_mesh(*b.info);
  const Separation first = are_meshes ? Separation{.distance_m = kInfinity} : first_bound(a, b, cost, deadline);
  NearestPair nearest{first, first.distance_m - first.error_m};
  if (are_meshes) search_meshes(a, b, nearest, cost, deadline);
  bool again = !are_meshes;
  while (again) {
    again = false;
    const double gap_m = nearest.reach_m();
    const auto visit = [&](const PlacedPart& of_a, const PlacedPart& of_b) {
      if (deadline.is_over()) return again = false;
      nearest.take(separation(of_a.part, of_b.part));
      again = nearest.reach_m() < kMuchNearer * gap_m;
      return !again;
    };
    visit_part_pairs(a, b, gap_m, visit, cost);
  }
  // The truly nearest pair may be any whose interval begins below the best one's.
  Separation best = nearest.best;
  best.error_m = std::max(best.error_m, best.distance_m - std::max(nearest.low_m, 0.0));
  // They are apart, so no distance is exactly 0.
  best.error_m = with_underflow(std::max(best.distance_m, std::numeric_limits<double>::denorm_min()), best.error_m);
  return best;
}

}  // namespace collided::engine
