#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/bsp_walk_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "server/broad_phase/bsp_walk-inl.hpp"
#include "server/broad_phase/bsp_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::bsp::HWY_NAMESPACE {

/// How many rays are on their way at once: enough that one's memory has come when its turn comes again, few enough
/// that their stacks stay in the nearest cache.
constexpr std::size_t kAtOnce = 16;

/// A ray between two turns.
struct Traveller {
  RayFrame ray;
  double limit = 0;
  float local_limit = 0;
  Ref ref = kNothing;
  unsigned met = 0;  // triangles of the leaf `ref` that wait for their corners
  bool has_indices = false;
  const BspTree::RayTask* task = nullptr;
  Frame* top = nullptr;
  HWY_ALIGN float estimate[kWidth];
  Frame stack[kMaxDepth + 1];
};

template <bool kCorners>
class Journey {
 public:
  Journey(const Layout& layout, const TriangleMesh& mesh, BspTree::RayTriangle candidate)
      : layout_(layout),
        mesh_(mesh),
        candidate_(candidate),
        nodes_(layout.nodes.data()),
        leaves_(layout.leaves.data()) {}

  /// False: the ray meets nothing here.
  HWY_INLINE bool start(const BspTree::RayTask& task, Traveller& t) const {
    if (!(task.limit >= 0) || !prepare_ray(layout_, *task.ray, 0, t.ray)) return false;
    t.task = &task;
    t.limit = task.limit;
    t.local_limit = t.ray.local_limit(task.limit);
    t.ref = layout_.root;
    t.met = 0;
    t.top = t.stack;
    return t.local_limit >= 0;
  }

  /// One node or leaf; false once the ray's walk is over. What the next turn reads has been sent for.
  HWY_INLINE bool turn(Traveller& t) const {
    if (t.met != 0) {
      if (!tell(t)) return false;
      return t.met != 0 || climb(t);
    }
    ++t.task->cost->nodes;
    return is_leaf(t.ref) ? visit_leaf(t) : visit_node(t);
  }

 private:
  HWY_INLINE bool visit_node(Traveller& t) const {
    const Node& node = nodes_[t.ref];
    const std::uint32_t order = node.order[t.ray.octant];
    const unsigned mask = met_children(node, t.ray, t.local_limit, order, t.top->entry);
    if (mask == 0) return climb(t);
    t.ref = node.child[child_at(order, static_cast<unsigned>(__builtin_ctz(mask)))];
    fetch(nodes_, leaves_, t.ref);
    t.top->node = &node;
    t.top->order = order;
    t.top->mask = mask & (mask - 1);
    t.top += t.top->mask != 0 ? 1 : 0;
    return true;
  }

  HWY_INLINE bool visit_leaf(Traveller& t) const {
    const Leaf& leaf = leaves_[t.ref & kIndexMask];
    const unsigned present = (2u << (leaf_count(t.ref) - 1)) - 1;
    const float cap = t.local_limit < t.ray.parameter_cap ? t.local_limit : t.ray.parameter_cap;
    t.met = met_triangles<kCorners>(leaf, t.ray, cap, t.estimate) & present;
    if (t.met == 0) return climb(t);
    if constexpr (kCorners) {
      if (!tell(t)) return false;
      return climb(t);
    }
    // The way to the corners leads over the mesh's index: two turns of waiting.
    for (unsigned rest = t.met; rest != 0; rest &= rest - 1) {
      __builtin_prefetch(&mesh_.triangles[leaf.triangle[__builtin_ctz(rest)]]);
    }
    t.has_indices = false;
    return true;
  }

  /// False: the limit says that nothing more matters.
  HWY_INLINE bool tell(Traveller& t) const {
    const Leaf& leaf = leaves_[t.ref & kIndexMask];
    if (!kCorners && !t.has_indices) {
      for (unsigned rest = t.met; rest != 0; rest &= rest - 1) {
        const TriangleCorners& corners = mesh_.triangles[leaf.triangle[__builtin_ctz(rest)]];
        for (const std::uint32_t corner : corners) __builtin_prefetch(&mesh_.vertices[corner]);
      }
      t.has_indices = true;
      return true;
    }
    const TriangleCall call{candidate_, t.task->context, mesh_, layout_.frame};
    t.limit = tell_triangles<kCorners>(call, leaf, t.met, t.estimate, t.limit, *t.task->cost);
    t.met = 0;
    t.local_limit = t.ray.local_limit(t.limit);
    return t.local_limit >= 0;
  }

  /// To the nearest child that still waits and is not beyond the limit.
  HWY_INLINE bool climb(Traveller& t) const {
    float entry;
    do {
      if (t.top == t.stack) return false;
      Frame& waiting = t.top[-1];
      const auto place = static_cast<unsigned>(__builtin_ctz(waiting.mask));
      waiting.mask &= waiting.mask - 1;
      t.top -= waiting.mask == 0 ? 1 : 0;
      entry = waiting.entry[place];
      t.ref = waiting.node->child[child_at(waiting.order, place)];
    } while (entry > t.local_limit);
    fetch(nodes_, leaves_, t.ref);
    return true;
  }

  const Layout& layout_;
  const TriangleMesh& mesh_;
  BspTree::RayTriangle candidate_;
  const Node* nodes_;
  const Leaf* leaves_;
};

template <bool kCorners>
void walk_in_turn(const Journey<kCorners>& journey, std::span<const BspTree::RayTask> tasks) {
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

void WalkRays(const Layout& layout, std::span<const BspTree::RayTask> tasks, const TriangleMesh& mesh,
              BspTree::RayTriangle candidate) {
  if (layout.has_corners) {
    walk_in_turn(Journey<true>(layout, mesh, candidate), tasks);
  } else {
    walk_in_turn(Journey<false>(layout, mesh, candidate), tasks);
  }
}

}  // namespace collided::bsp::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::bsp {

HWY_EXPORT(WalkRays);

void walk_rays(const Layout& layout, std::span<const BspTree::RayTask> tasks, const TriangleMesh& mesh,
               BspTree::RayTriangle candidate) {
  HWY_DYNAMIC_DISPATCH(WalkRays)(layout, tasks, mesh, candidate);
}

}  // namespace collided::bsp
#endif
