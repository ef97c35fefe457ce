#pragma once

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/broad_phase/hierarchy/bvh_layout.hpp"

namespace collided::engine::bvh {

/// The walks of Bvh in SIMD, each compiled for every instruction set and chosen at run time. The layout must not be
/// empty and limits must not be negative.

void walk_ray(const Layout& layout, const Ray& ray, double limit, double slack_m, Bvh::RayCandidate candidate,
              WalkCost& cost);

void walk_ray(const Layout& layout, const Ray& ray, double limit, double slack_m, const TriangleMesh& mesh,
              Bvh::RayTriangle candidate, WalkCost& cost);

void walk_ray_nearest(const Layout& layout, const Ray& ray, double limit, const TriangleMesh& mesh,
                      Bvh::RayTriangle candidate, WalkCost& cost);

std::uint32_t meet_ray(const Layout& layout, const Ray& ray, double limit, const TriangleMesh& mesh,
                       Bvh::RayTriangle candidate, WalkCost& cost, Triangle& corners);

/// Uses whichever of the two functions below suits the first rays; only the cost differs.
void walk_rays(const Layout& layout, std::span<Bvh::RayTask> tasks, const TriangleMesh& mesh, Bvh::RayGoal goal);
void walk_rays_in_turn(const Layout& layout, std::span<Bvh::RayTask> tasks, const TriangleMesh& mesh,
                       Bvh::RayGoal goal);
/// Eight rays at a time through each node; for the goals nearest and any.
void walk_ray_packets(const Layout& layout, std::span<Bvh::RayTask> tasks, const TriangleMesh& mesh, Bvh::RayGoal goal);

/// Walks that end in `_boxes` are for a BoxTree, in which a leaf child is one box, by its number.
void walk_ray_boxes(const Layout& layout, const Ray& ray, double limit, Bvh::RayCandidate candidate, WalkCost& cost);

/// A box in local coordinates, already grown by all roundings.
struct LocalBox {
  float low[3];
  float high[3];
};
LocalBox local_box(const LocalFrame& frame, const Aabb& asked);
void walk_box(const Layout& layout, const LocalBox& asked, Bvh::BoxCandidate candidate, WalkCost& cost);
void walk_box_boxes(const Layout& layout, const LocalBox& asked, Bvh::BoxCandidate candidate, WalkCost& cost);

/// The low and high ends of a point's coordinates, already grown by all roundings. Squared distances times limit_scale
/// squared are local; multiply twice, because the square itself may not fit a double.
struct LocalPoint {
  float low[3];
  float high[3];
  double limit_scale;

  float local_limit(double limit_m2) const;
};
/// A point that is known to within slack_m.
LocalPoint local_point(const LocalFrame& frame, const Vec3& point, double slack_m);
void walk_near(const Layout& layout, const LocalPoint& point, double limit_m2, Bvh::NearCandidate candidate,
               WalkCost& cost);
void walk_near_boxes(const Layout& layout, const LocalPoint& point, double limit_m2, Bvh::NearCandidate candidate,
                     WalkCost& cost);

}  // namespace collided::engine::bvh
