#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/hierarchy/bvh_walk_ray.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "server/broad_phase/hierarchy/bvh_walk-inl.hpp"
#include "server/broad_phase/hierarchy/bvh_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::bvh::HWY_NAMESPACE {

using Goal = Bvh::RayGoal;

/// One ray's walk through the tree; for Goal::any it returns the triangle hit, and its corners.
template <Goal kGoal, bool kCorners, class Call>
HWY_INLINE std::uint32_t walk_prepared(const Layout& layout, const RayFrame& ray, double limit, const Call& call,
                                       WalkCost& cost, [[maybe_unused]] Triangle* corners) {
  constexpr Way kWay = kGoal == Goal::any ? Way::most_occluding_first : Way::near_first;
  const Node* nodes = layout.nodes.data();
  const Leaf* leaves = layout.leaves.data();
  const Slabs slabs(ray);
  const float sure_limit = kGoal == Goal::any ? ray.sure_limit(limit) : 0;
  SureHits sure_hits;
  WalkFrame stack[kMaxDepth + 1];
  WalkFrame* top = stack;
  WalkReach reach{limit, ray.local_limit(limit)};
  if (reach.local < 0) return Bvh::kNoTriangle;
  Ref ref = layout.root;
  while (true) {
    ++cost.nodes;
    if (is_leaf(ref)) {
      const Leaf& leaf = leaves[ref & kIndexMask];
      const unsigned present = (2u << (leaf_count(ref) - 1)) - 1;
      const TriangleTest<kCorners> test(leaf, ray);
      const unsigned met = test.met(reach.local < ray.parameter_cap ? reach.local : ray.parameter_cap) & present;
      if (met != 0) {
        if constexpr (kGoal == Goal::any) {
          const unsigned sure = test.sure_within(sure_limit);
          const std::uint32_t found = first_met<kCorners>(call, ray, leaf, met, sure, reach, cost, *corners);
          if (found != Bvh::kNoTriangle) return found;
        } else if constexpr (kGoal == Goal::nearest) {
          if (!sure_hits.visit<kCorners>(call, ray, leaf, test, met, reach, cost)) return Bvh::kNoTriangle;
        } else {
          HWY_ALIGN float estimate[kWidth];
          test.estimate(estimate);
          if (!tell_every<kCorners>(call, ray, leaf, met, estimate, reach, cost)) return Bvh::kNoTriangle;
        }
      }
    } else {
      const unsigned waiting = met_children<kWay>(nodes[ref], slabs, reach.local, *top);
      if (waiting != 0) {
        ref = top->child[place_of(waiting)];
        const unsigned rest = waiting & (waiting - 1);
        top->waiting = rest;
        // Without a branch, which would be hard to predict: if nothing waits, what is read next is fetched again.
        fetch(nodes, leaves, top->child[place_of(rest != 0 ? rest : waiting)]);
        top += rest != 0 ? 1 : 0;
        continue;
      }
    }
    if (!climb(stack, reach.local, top, ref)) break;
  }
  if constexpr (kGoal == Goal::nearest) sure_hits.settle<kCorners>(call, ray, reach, cost);
  return Bvh::kNoTriangle;
}

template <Goal kGoal, class Call>
HWY_INLINE std::uint32_t walk_any(const Layout& layout, const Ray& world_ray, double limit, double slack_m,
                                  const Call& call, WalkCost& cost, Triangle* corners = nullptr) {
  RayFrame ray;
  if (!prepare_ray(layout, world_ray, slack_m, ray)) return Bvh::kNoTriangle;
  return layout.has_corners ? walk_prepared<kGoal, true>(layout, ray, limit, call, cost, corners)
                            : walk_prepared<kGoal, false>(layout, ray, limit, call, cost, corners);
}

void WalkRay(const Layout& layout, const Ray& ray, double limit, double slack_m, Bvh::RayCandidate candidate,
             WalkCost& cost) {
  walk_any<Goal::every>(layout, ray, limit, slack_m, NumberCall{candidate}, cost);
}

void WalkRayTriangles(const Layout& layout, const Ray& ray, double limit, double slack_m, const TriangleMesh& mesh,
                      Bvh::RayTriangle candidate, WalkCost& cost) {
  walk_any<Goal::every>(layout, ray, limit, slack_m, TriangleCall{candidate, mesh, layout.frame}, cost);
}

void WalkRayNearest(const Layout& layout, const Ray& ray, double limit, const TriangleMesh& mesh,
                    Bvh::RayTriangle candidate, WalkCost& cost) {
  walk_any<Goal::nearest>(layout, ray, limit, 0, TriangleCall{candidate, mesh, layout.frame}, cost);
}

std::uint32_t MeetRay(const Layout& layout, const Ray& ray, double limit, const TriangleMesh& mesh,
                      Bvh::RayTriangle candidate, WalkCost& cost, Triangle& corners) {
  return walk_any<Goal::any>(layout, ray, limit, 0, TriangleCall{candidate, mesh, layout.frame}, cost, &corners);
}

/// Visits the boxes themselves, each a child of a node.
void WalkRayBoxes(const Layout& layout, const Ray& world_ray, double limit, Bvh::RayCandidate candidate,
                  WalkCost& cost) {
  RayFrame ray;
  if (!prepare_ray(layout, world_ray, 0, ray)) return;
  const Slabs slabs(ray);
  WalkFrame stack[kMaxDepth + 1];
  WalkFrame* top = stack;
  WalkReach reach{limit, ray.local_limit(limit)};
  if (reach.local < 0) return;
  Ref ref = layout.root;
  while (true) {
    if (is_leaf(ref)) {
      ++cost.candidates;
      reach.shorten(ray, candidate(ref & kIndexMask, reach.limit));
      if (reach.is_over()) return;
    } else {
      ++cost.nodes;
      const unsigned waiting = met_children<Way::near_first>(layout.nodes[ref], slabs, reach.local, *top);
      if (waiting != 0) {
        ref = top->child[place_of(waiting)];
        top->waiting = waiting & (waiting - 1);
        top += top->waiting != 0 ? 1 : 0;
        continue;
      }
    }
    if (!climb(stack, reach.local, top, ref)) return;
  }
}

}  // namespace collided::engine::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::bvh {

HWY_EXPORT(WalkRay);
HWY_EXPORT(WalkRayTriangles);
HWY_EXPORT(WalkRayNearest);
HWY_EXPORT(MeetRay);
HWY_EXPORT(WalkRayBoxes);

void walk_ray(const Layout& layout, const Ray& ray, double limit, double slack_m, Bvh::RayCandidate candidate,
              WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkRay)(layout, ray, limit, slack_m, candidate, cost);
}

void walk_ray(const Layout& layout, const Ray& ray, double limit, double slack_m, const TriangleMesh& mesh,
              Bvh::RayTriangle candidate, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkRayTriangles)(layout, ray, limit, slack_m, mesh, candidate, cost);
}

void walk_ray_nearest(const Layout& layout, const Ray& ray, double limit, const TriangleMesh& mesh,
                      Bvh::RayTriangle candidate, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkRayNearest)(layout, ray, limit, mesh, candidate, cost);
}

std::uint32_t meet_ray(const Layout& layout, const Ray& ray, double limit, const TriangleMesh& mesh,
                       Bvh::RayTriangle candidate, WalkCost& cost, Triangle& corners) {
  return HWY_DYNAMIC_DISPATCH(MeetRay)(layout, ray, limit, mesh, candidate, cost, corners);
}

void walk_ray_boxes(const Layout& layout, const Ray& ray, double limit, Bvh::RayCandidate candidate, WalkCost& cost) {
  HWY_DYNAMIC_DISPATCH(WalkRayBoxes)(layout, ray, limit, candidate, cost);
}

}  // namespace collided::engine::bvh
#endif
