#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/hierarchy/bvh_walk_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "server/broad_phase/hierarchy/bvh_walk-inl.hpp"
#include "server/broad_phase/hierarchy/bvh_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::bvh::HWY_NAMESPACE {

/// Rays in progress at once: enough that a ray's memory has arrived when its turn comes again, few enough that their
/// stacks stay in the nearest cache.
constexpr std::size_t kAtOnce = 16;

using Goal = Bvh::RayGoal;

/// The state of a ray between two turns.
struct Traveller {
  RayFrame ray;
  WalkReach reach = {};
  float sure_limit = 0;
  Ref ref = kNothing;
  unsigned met = 0;        // triangles of the leaf `ref` that wait for their corners
  int fetched = 0;         // stage of prefetching the corners: 0 nothing, 1 indices, 2 corners
  bool is_ending = false;  // only certain hits are left to offer
  Bvh::RayTask* task = nullptr;
  WalkFrame* top = nullptr;
  SureHits sure_hits;
  HWY_ALIGN float estimate[kWidth];
  WalkFrame stack[kMaxDepth + 1];
};

/// The steps of many rays' walks; the state of each is in its Traveller.
template <Goal kGoal, bool kCorners>
class Journey {
 public:
  Journey(const Layout& layout, const TriangleMesh& mesh)
      : layout_(layout), mesh_(mesh), nodes_(layout.nodes.data()), leaves_(layout.leaves.data()) {}

  /// False if the ray meets nothing in this tree.
  HWY_INLINE bool start(Bvh::RayTask& task, Traveller& t) const {
    if (!(task.limit >= 0) || !prepare_ray(layout_, *task.ray, 0, t.ray)) return false;
    t.task = &task;
    t.reach = {task.limit, t.ray.local_limit(task.limit)};
    if constexpr (kGoal == Goal::any) t.sure_limit = t.ray.sure_limit(task.limit);
    t.ref = layout_.root;
    t.met = 0;
    t.is_ending = false;
    t.sure_hits.clear();
    t.top = t.stack;
    return t.reach.local >= 0;
  }

  /// Visits one node or leaf, and prefetches data for the next turn; false once the ray's walk is over.
  HWY_INLINE bool turn(Traveller& t) const {
    if constexpr (kGoal == Goal::nearest) {
      if (t.is_ending) return end(t);
    }
    if constexpr (kGoal == Goal::every && !kCorners) {
      if (t.met != 0) return tell_waiting(t);
    }
    ++t.task->cost->nodes;
    return is_leaf(t.ref) ? visit_leaf(t) : visit_node(t);
  }

 private:
  HWY_INLINE TriangleCall call_of(const Traveller& t) const { return {t.task->candidate, mesh_, layout_.frame}; }

  HWY_INLINE bool visit_node(Traveller& t) const {
    constexpr Way kWay = kGoal == Goal::any ? Way::most_occluding_first : Way::near_first;
    const unsigned waiting = met_children<kWay>(nodes_[t.ref], Slabs(t.ray), t.reach.local, *t.top);
    if (waiting == 0) return next(t);
    t.ref = t.top->child[place_of(waiting)];
    fetch(nodes_, leaves_, t.ref);
    t.top->waiting = waiting & (waiting - 1);
    t.top += t.top->waiting != 0 ? 1 : 0;
    return true;
  }

  HWY_INLINE bool visit_leaf(Traveller& t) const {
    const Leaf& leaf = leaves_[t.ref & kIndexMask];
    const unsigned present = (2u << (leaf_count(t.ref) - 1)) - 1;
    const TriangleTest<kCorners> test(leaf, t.ray);
    const float cap = t.reach.local < t.ray.parameter_cap ? t.reach.local : t.ray.parameter_cap;
    const unsigned met = test.met(cap) & present;
    if (met == 0) return next(t);
    WalkCost& cost = *t.task->cost;
    if constexpr (kGoal == Goal::any) {
      const unsigned sure = test.sure_within(t.sure_limit);
      t.task->met = first_met<kCorners>(call_of(t), t.ray, leaf, met, sure, t.reach, cost, t.task->corners);
      return t.task->met == Bvh::kNoTriangle && next(t);
    } else if constexpr (kGoal == Goal::nearest) {
      return t.sure_hits.template visit<kCorners>(call_of(t), t.ray, leaf, test, met, t.reach, cost) && next(t);
    } else {
      test.estimate(t.estimate);
      if constexpr (kCorners) {
        return tell_every<kCorners>(call_of(t), t.ray, leaf, met, t.estimate, t.reach, cost) && next(t);
      }
      t.met = met;
      t.fetched = 0;
      return tell_waiting(t);
    }
  }

  /// Corners are found through the mesh's index: two turns of prefetching.
  HWY_INLINE bool tell_waiting(Traveller& t) const {
    const Leaf& leaf = leaves_[t.ref & kIndexMask];
    if (t.fetched < 2) {
      for (unsigned rest = t.met; rest != 0; rest &= rest - 1) fetch_corners(leaf, __builtin_ctz(rest), t.fetched);
      ++t.fetched;
      return true;
    }
    const unsigned met = t.met;
    t.met = 0;
    return tell_every<kCorners>(call_of(t), t.ray, leaf, met, t.estimate, t.reach, *t.task->cost) && next(t);
  }

  /// Reports the certain hits when nothing nearer can follow; if their corners must be prefetched, two turns later.
  HWY_INLINE bool end(Traveller& t) const {
    if (!kCorners && t.fetched < 2) {
      for (int i = 0; i < t.sure_hits.count(); ++i) fetch_corners(t.sure_hits.leaf(i), t.sure_hits.lane(i), t.fetched);
      ++t.fetched;
      return true;
    }
    t.sure_hits.template settle<kCorners>(call_of(t), t.ray, t.reach, *t.task->cost);
    return false;
  }

  HWY_INLINE void fetch_corners(const Leaf& leaf, int lane, int stage) const {
    const TriangleCorners& corners = mesh_.triangles[leaf.triangle[lane]];
    if (stage == 0) {
      __builtin_prefetch(&corners);
    } else {
      for (const std::uint32_t corner : corners) __builtin_prefetch(&mesh_.vertices[corner]);
    }
  }

  /// Goes to the next waiting child that is not beyond the limit.
  HWY_INLINE bool next(Traveller& t) const {
    if (climb(t.stack, t.reach.local, t.top, t.ref)) {
      fetch(nodes_, leaves_, t.ref);
      return true;
    }
    if (kGoal != Goal::nearest || t.sure_hits.empty()) return false;
    t.is_ending = true;
    t.fetched = 0;
    return end(t);
  }

  const Layout& layout_;
  const TriangleMesh& mesh_;
  const Node* nodes_;
  const Leaf* leaves_;
};

/// Gives each ray in progress a turn, replacing those that finish, until all tasks are done.
template <Goal kGoal, bool kCorners>
void walk_in_turn(const Journey<kGoal, kCorners>& journey, std::span<Bvh::RayTask> tasks) {
  Traveller travellers[kAtOnce];
  std::size_t next = 0;
  const auto start_another = [&](Traveller& t) {
    while (next < tasks.size()) {
      if (journey.start(tasks[next++], t)) return true;
    }
    return false;
  };
  std::size_t under_way = 0;
  std::size_t place[kAtOnce];
  for (std::size_t i = 0; i < kAtOnce && start_another(travellers[i]); ++i) place[under_way++] = i;
  while (under_way > 0) {
    for (std::size_t i = 0; i < under_way;) {
      Traveller& t = travellers[place[i]];
      if (journey.turn(t) || start_another(t)) {
        ++i;
      } else {
        place[i] = place[--under_way];
      }
    }
  }
}

template <Goal kGoal>
void walk_rays_for(const Layout& layout, std::span<Bvh::RayTask> tasks, const TriangleMesh& mesh) {
  if (layout.has_corners) {
    walk_in_turn(Journey<kGoal, true>(layout, mesh), tasks);
  } else {
    walk_in_turn(Journey<kGoal, false>(layout, mesh), tasks);
  }
}

void WalkRays(const Layout& layout, std::span<Bvh::RayTask> tasks, const TriangleMesh& mesh, Goal goal) {
  if (goal == Goal::nearest) return walk_rays_for<Goal::nearest>(layout, tasks, mesh);
  if (goal == Goal::any) return walk_rays_for<Goal::any>(layout, tasks, mesh);
  walk_rays_for<Goal::every>(layout, tasks, mesh);
}

}  // namespace collided::engine::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::bvh {

HWY_EXPORT(WalkRays);

void walk_rays_in_turn(const Layout& layout, std::span<Bvh::RayTask> tasks, const TriangleMesh& mesh,
                       Bvh::RayGoal goal) {
  HWY_DYNAMIC_DISPATCH(WalkRays)(layout, tasks, mesh, goal);
}

}  // namespace collided::engine::bvh
#endif
