#include "server/world/groups/nearest_parts.hpp"

#include <cmath>

#include "server/exact_phase/distance/triangle_depth.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {

double NearestParts::reach_m() const { return std::min(limit_m, best.distance_m + best.error_m) * (1 + kBoundSlack); }

void NearestParts::take(const ConvexPart& a, std::uint32_t of_a, const ConvexPart& b, std::uint32_t of_b) {
  if (ends_at_overlap && overlaps(a, b).decision != Decision::no) {
    may_overlap = true;
    return;
  }
  const Separation here = separation(a, b);
  low_m = std::min(low_m, here.distance_m - here.error_m);
  if (!(here.distance_m < best.distance_m)) return;
  best = here;
  a_triangle = of_a;
  b_triangle = of_b;
}

namespace {

/// A ball around all of a part, or around the part of a mesh that may be near a half-space.
struct BallAround {
  Vec3 center;
  double radius_m;
  double across_m = 0;  // points within reach of the part may be this far off the ball's middle axis

  /// Every point of the mesh within reach of the part is this near the centre, squared.
  double square(double reach_m) const {
    const double along_m = radius_m + reach_m;
    return (along_m * along_m + across_m * across_m) * (1 + kBoundSlack);
  }
};

/// A half-space is represented by a ball around a point deep inside, so large that it is nearly flat near the mesh.
BallAround ball_around(const ConvexPart& part, const Placed& mesh) {
  if (const HalfSpace* ground = half_space_of(part)) {
    constexpr double kFlat = 64;
    const Vec3 up = ground->normal.normalized();
    const double across_m = mesh.info->mesh->radius_m;
    const double deep_m = kFlat * across_m;
    const Vec3 foot = mesh.frame.position - up * up.dot(mesh.frame.position - ground->point);
    return {foot - deep_m * up, deep_m, across_m};
  }
  const Aabb box = bounds_of_part(part);
  const Vec3 center = 0.5 * box.low + 0.5 * box.high;
  return {center, (box.high - center).cwiseMax(center - box.low).norm()};
}

/// Calls test(placed triangle, its number) for those of the mesh that may be within reach of the part, near first.
template <class Test>
void near_mesh_triangles(const ConvexPart& part, const Placed& object, const NearestParts& nearest, WalkCost& cost,
                         Deadline& deadline, Test&& test) {
  const IndexedMesh& mesh = *object.info->mesh;
  const BallAround ball = ball_around(part, object);
  const auto candidate = [&](std::uint32_t number, double) {
    if (deadline.is_over() || nearest.may_overlap) return -1.0;
    test(place(object.frame, mesh.mesh->triangle(number)), number);
    return nearest.may_overlap ? -1.0 : ball.square(nearest.reach_m());
  };
  const Vec3 local = object.frame.rotation.transpose() * (ball.center - object.frame.position);
  mesh.tree.walk_near(local, ball.square(nearest.reach_m()),
                      placement_slack(object.frame, 2 * ball.center.lpNorm<1>(), mesh.radius_m), candidate, cost);
}

/// Tests the primitives of one object against all of another; `taking` passes a pair on in the right order.
template <class Take>
void primitives_against(const Placed& one, const Placed& other, const NearestParts& nearest, bool with_primitives,
                        WalkCost& cost, Deadline& deadline, Take&& taking) {
  const auto goes_on = [&] { return !nearest.may_overlap && !deadline.is_over(); };
  visit_primitives_near(*one.info, one.frame, grown(other.bounds, nearest.reach_m()), cost, [&](const Primitive& own) {
    const ConvexPart part = place(one.frame, own);
    if (with_primitives) {
      const Aabb near = other.info->rare->parts ? grown(bounds_of_part(part), nearest.reach_m()) : Aabb{};
      visit_primitives_near(*other.info, other.frame, near, cost, [&](const Primitive& second) {
        taking(part, place(other.frame, second), kNoTriangle);
        return goes_on();
      });
    }
    if (!goes_on() || !other.info->mesh) return goes_on();
    near_mesh_triangles(part, other, nearest, cost, deadline,
                        [&](const Triangle& triangle, std::uint32_t number) { taking(part, triangle, number); });
    return goes_on();
  });
}

void nearest_of_meshes(const Placed& a, const Placed& b, NearestParts& nearest, WalkCost& cost, Deadline& deadline) {
  PlacedTriangles of_a(*a.info->mesh->mesh, a.frame);
  PlacedTriangles of_b(*b.info->mesh->mesh, b.frame);
  const auto candidate = [&](std::uint32_t triangle_a, std::uint32_t triangle_b, double) {
    if (deadline.is_over()) return -1.0;
    const Triangle& first = of_a.at(triangle_a);
    const Triangle& second = of_b.at(triangle_b);
    // The index rounds corners to floats; doubles rule out most of many almost equally near pairs.
    if (!(kernel::gap_at_least(first, second) > nearest.reach_m())) nearest.take(first, triangle_a, second, triangle_b);
    return nearest.may_overlap ? -1.0 : nearest.reach_m();
  };
  walk_near_mesh_pairs(
      a, b, nearest.reach_m(), candidate, [&] { return deadline.is_over(); }, cost);
}

}  // namespace

void find_nearest_parts(const Placed& a, const Placed& b, NearestParts& nearest, WalkCost& cost, Deadline& deadline) {
  primitives_against(a, b, nearest, true, cost, deadline,
                     [&](const ConvexPart& of_a, const ConvexPart& of_b, std::uint32_t triangle) {
                       nearest.take(of_a, kNoTriangle, of_b, triangle);
                     });
  if (nearest.may_overlap || !a.info->mesh) return;
  primitives_against(b, a, nearest, false, cost, deadline,
                     [&](const ConvexPart& of_b, const ConvexPart& of_a, std::uint32_t triangle) {
                       nearest.take(of_a, triangle, of_b, kNoTriangle);
                     });
  if (nearest.may_overlap || !b.info->mesh) return;
  nearest_of_meshes(a, b, nearest, cost, deadline);
}

}  // namespace collided::engine
