#include <limits>

#include "server/exact_phase/closest.hpp"
#include "server/world/pair_report.hpp"

namespace collided {
namespace {

/// A first bound: from one part of a to b's parts, where b is small; else any pair of parts will do to begin with.
ConvexPart any_part(const Placed& object) {
  if (!object.info->primitives.empty()) return place(*object.frame, object.info->primitives.front());
  return place(*object.frame, object.info->mesh->mesh->triangle(0));
}

/// A point of b's mesh near the point, from where the search comes nearer by going to and fro.
struct NearestTriangle {
  const Placed& object;
  Vec3 point;
  std::uint32_t triangle = 0;
  double best_m2 = std::numeric_limits<double>::infinity();

  static double candidate(void* raw, std::uint32_t number, double) {
    NearestTriangle& self = *static_cast<NearestTriangle*>(raw);
    const Closest found = closest(self.point, place(*self.object.frame, self.object.info->mesh->mesh->triangle(number)));
    const double m2 = found.distance_m * found.distance_m;
    if (m2 < self.best_m2) {
      self.best_m2 = m2;
      self.triangle = number;
    }
    return self.best_m2 * (1 + 0x1p-40);
  }
};

std::uint32_t nearest_triangle(const Placed& object, const Vec3& point, WalkCost& cost) {
  NearestTriangle search{object, point};
  const Vec3 local = object.frame->rotation.transpose() * (point - object.frame->position);
  const IndexedMesh& mesh = *object.info->mesh;
  mesh.tree.walk_near(local, std::numeric_limits<double>::infinity(),
                      placement_slack(*object.frame, point.lpNorm<1>(), mesh.radius_m), &NearestTriangle::candidate, &search, cost);
  return search.triangle;
}

/// Two parts whose distance is a good first bound.
Separation first_bound(const Placed& a, const Placed& b, WalkCost& cost) {
  ConvexPart of_a = any_part(a);
  ConvexPart of_b = any_part(b);
  Separation best = separation(of_a, of_b);
  constexpr int kTurns = 6;
  for (int i = 0; i < kTurns; ++i) {
    if (b.info->mesh && b.info->primitives.empty()) of_b = place(*b.frame, b.info->mesh->mesh->triangle(nearest_triangle(b, best.on_a, cost)));
    if (a.info->mesh && a.info->primitives.empty()) of_a = place(*a.frame, a.info->mesh->mesh->triangle(nearest_triangle(a, best.on_b, cost)));
    const Separation here = separation(of_a, of_b);
    if (!(here.distance_m < best.distance_m)) break;
    best = here;
  }
  return best;
}

}  // namespace

/// All pairs within the best known distance are asked; where one is much nearer, the walk begins again with less.
Separation distance_between(const Placed& a, const Placed& b, WalkCost& cost) {
  constexpr double kMuchNearer = 0.75;
  Separation best = first_bound(a, b, cost);
  double low_m = best.distance_m - best.error_m;
  bool again = true;
  while (again) {
    again = false;
    const double gap_m = (best.distance_m + best.error_m) * (1 + 0x1p-40);
    const auto visit = [&](const PlacedPart& of_a, const PlacedPart& of_b) {
      const Separation here = separation(of_a.part, of_b.part);
      low_m = std::min(low_m, here.distance_m - here.error_m);
      if (here.distance_m < best.distance_m) best = here;
      again = best.distance_m + best.error_m < kMuchNearer * gap_m;
      return !again;
    };
    visit_part_pairs(a, b, gap_m, visit, cost);
  }
  // The nearest may be any whose interval begins below the best one's.
  const double widened_m = best.distance_m - std::max(low_m, 0.0);
  best.error_m = std::max(best.error_m, widened_m);
  return best;
}

}  // namespace collided
