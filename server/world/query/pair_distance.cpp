// The distance of two separate objects.

#include <limits>

#include "server/exact_phase/distance/closest.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/objects/scene_touch.hpp"
#include "server/world/query/pair_report.hpp"
#include "server/world/query/underflow.hpp"

namespace collided::engine {
namespace {

/// A part to start from; first_bound() improves on it.
ConvexPart any_part(const Placed& object) {
  if (!object.info->primitives.empty()) return place(*object.frame, object.info->primitives.front());
  return place(*object.frame, object.info->mesh->mesh->triangle(0));
}

/// The triangle of the mesh that is nearest to the point. Alternating between the two objects brings them closer.
std::uint32_t nearest_triangle(const Placed& object, const Vec3& point, WalkCost& cost, Deadline& deadline) {
  const Vec3 local = object.frame->rotation.transpose() * (point - object.frame->position);
  const IndexedMesh& mesh = *object.info->mesh;
  std::uint32_t triangle = 0;
  double best_m2 = std::numeric_limits<double>::infinity();
  const auto candidate = [&](std::uint32_t number, double) {
    if (deadline.is_over()) return -1.0;
    const Closest found = closest(point, place(*object.frame, mesh.mesh->triangle(number)));
    const double m2 = found.distance_m * found.distance_m;
    if (m2 < best_m2) {
      best_m2 = m2;
      triangle = number;
    }
    return best_m2 * (1 + kBoundSlack);
  };
  mesh.tree.walk_near(local, std::numeric_limits<double>::infinity(),
                      placement_slack(*object.frame, point.lpNorm<1>(), mesh.radius_m), candidate, cost);
  return triangle;
}

/// Two parts whose distance is a good first bound: alternates between the meshes while that helps.
Separation first_bound(const Placed& a, const Placed& b, WalkCost& cost, Deadline& deadline) {
  ConvexPart of_a = any_part(a);
  ConvexPart of_b = any_part(b);
  Separation best = separation(of_a, of_b);
  constexpr int kTurns = 6;
  for (int i = 0; i < kTurns; ++i) {
    if (b.info->mesh && b.info->primitives.empty())
      of_b = place(*b.frame, b.info->mesh->mesh->triangle(nearest_triangle(b, best.on_a, cost, deadline)));
    if (a.info->mesh && a.info->primitives.empty())
      of_a = place(*a.frame, a.info->mesh->mesh->triangle(nearest_triangle(a, best.on_b, cost, deadline)));
    const Separation here = separation(of_a, of_b);
    if (!(here.distance_m < best.distance_m)) break;
    best = here;
  }
  return best;
}

/// The nearest pair so far, and a distance below which no tested pair is.
struct NearestPair {
  Separation best;
  double low_m;

  void take(const Separation& here) {
    low_m = std::min(low_m, here.distance_m - here.error_m);
    if (here.distance_m < best.distance_m) best = here;
  }
  double reach_m() const { return (best.distance_m + best.error_m) * (1 + kBoundSlack); }
};

/// Tests one triangle of a mesh against those of the other that may be nearer than the nearest so far.
struct TriangleWalk {
  const Placed& other;
  Triangle triangle;
  bool is_of_a;
  double radius_m;  // of the triangle, about the point from which the walk starts
  NearestPair& nearest;
  Deadline& deadline;

  double operator()(std::uint32_t number, double) const {
    if (deadline.is_over()) return -1;
    const Triangle found = place(*other.frame, other.info->mesh->mesh->triangle(number));
    nearest.take(is_of_a ? separation(triangle, found) : separation(found, triangle));
    return limit_m2();
  }
  double limit_m2() const { return square_up(nearest.reach_m() + radius_m); }
};

/// Two meshes: walks the larger one's index from each triangle of the smaller. A walk over pairs of boxes would meet
/// most pairs where one shell lies in the other.
void search_meshes(const Placed& a, const Placed& b, NearestPair& nearest, WalkCost& cost, Deadline& deadline) {
  const bool from_a = a.info->mesh->mesh->triangles.size() <= b.info->mesh->mesh->triangles.size();
  const Placed& from = from_a ? a : b;
  const Placed& other = from_a ? b : a;
  const IndexedMesh& mesh = *other.info->mesh;
  for (std::uint32_t i = 0; i < from.info->mesh->mesh->triangles.size() && !deadline.is_over(); ++i) {
    const Triangle triangle = place(*from.frame, from.info->mesh->mesh->triangle(i));
    const Vec3 middle = triangle.a / 3 + triangle.b / 3 + triangle.c / 3;
    const double radius_m =
        std::max({(triangle.a - middle).norm(), (triangle.b - middle).norm(), (triangle.c - middle).norm()}) *
        (1 + kBoundSlack);
    const TriangleWalk walk{other, triangle, from_a, radius_m, nearest, deadline};
    const Vec3 local = other.frame->rotation.transpose() * (middle - other.frame->position);
    mesh.tree.walk_near(local, walk.limit_m2(), placement_slack(*other.frame, middle.lpNorm<1>(), mesh.radius_m), walk,
                        cost);
  }
}

bool is_bare_mesh(const Placed& object) { return object.info->mesh && object.info->primitives.empty(); }

}  // namespace

/// Tests all pairs within the best known distance; where a much nearer pair is found, the walk starts again with that
/// distance.
Separation distance_between(const Placed& a, const Placed& b, WalkCost& cost, Deadline& deadline) {
  constexpr double kMuchNearer = 0.75;
  const Separation first = first_bound(a, b, cost, deadline);
  NearestPair nearest{first, first.distance_m - first.error_m};
  const bool are_meshes = is_bare_mesh(a) && is_bare_mesh(b);
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
