#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "server/broad_phase/hierarchy/bvh_walk_packets.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "server/broad_phase/hierarchy/bvh_walk-inl.hpp"
#include "server/broad_phase/hierarchy/bvh_walk.hpp"

HWY_BEFORE_NAMESPACE();
namespace collided::engine::bvh::HWY_NAMESPACE {

using Goal = Bvh::RayGoal;

/// A waiting child, with the parameter at which each ray enters it; infinity if it does not.
struct alignas(32) WaitingNode {
  float entry[kWidth];
  Ref ref;
};

/// Walks rays through the same children in the same order, one lane each: a node is loaded once for all of them, and no
/// ray waits for another's arithmetic. In a leaf each ray is tested separately, by the same tests as for a single ray.
template <Goal kGoal, bool kCorners>
class Packet {
 public:
  Packet(const Layout& layout, const TriangleMesh& mesh) : layout_(layout), mesh_(mesh) {}

  /// False, without doing anything, if the rays do not agree on the order of children.
  bool walk(std::span<Bvh::RayTask> tasks) {
    tasks_ = tasks;
    first_ = nullptr;
    for (std::size_t i = 0; i < tasks.size(); ++i) {
      is_under_way_[i] = tasks[i].limit >= 0 && prepare_ray(layout_, *tasks[i].ray, 0, ray_[i]);
      if (!is_under_way_[i]) continue;
      if (first_ == nullptr) first_ = &ray_[i];
      if (ray_[i].octant != first_->octant) return false;
    }
    if (first_ == nullptr) return true;
    fill();
    descend();
    if constexpr (kGoal == Goal::nearest) {
      for (std::size_t i = 0; i < tasks.size(); ++i) {
        if (is_under_way_[i] && !reach_[i].is_over())
          sure_hits_[i].template settle<kCorners>(call_of(i), ray_[i], reach_[i], *tasks[i].cost);
      }
    }
    return true;
  }

 private:
  HWY_INLINE TriangleCall call_of(std::size_t i) const { return {tasks_[i].candidate, mesh_, layout_.frame}; }

  void fill() {
    for (std::size_t i = 0; i < kWidth; ++i) {
      const bool is_ray = i < tasks_.size() && is_under_way_[i];
      const RayFrame& ray = is_ray ? ray_[i] : *first_;
      for (int axis = 0; axis < 3; ++axis) {
        inverse_[axis][i] = ray.inverse[axis];
        near_offset_[axis][i] = ray.near_offset[axis];
        far_offset_[axis][i] = ray.far_offset[axis];
      }
      visited_[i] = 0;
      limit_[i] = -1;
      if (!is_ray) continue;
      reach_[i] = {tasks_[i].limit, ray.local_limit(tasks_[i].limit)};
      // Finite, so that a child that is not entered stays beyond it.
      limit_[i] = std::min(reach_[i].local, std::numeric_limits<float>::max());
      if constexpr (kGoal == Goal::any) sure_limit_[i] = ray.sure_limit(tasks_[i].limit);
      sure_hits_[i].clear();
    }
    for (int axis = 0; axis < 3; ++axis) {
      least_inverse_[axis] = *std::min_element(inverse_[axis], inverse_[axis] + kWidth);
      most_inverse_[axis] = *std::max_element(inverse_[axis], inverse_[axis] + kWidth);
      most_near_offset_[axis] = *std::max_element(near_offset_[axis], near_offset_[axis] + kWidth);
      least_far_offset_[axis] = *std::min_element(far_offset_[axis], far_offset_[axis] + kWidth);
    }
  }

  void descend() {
    const RayFrame& first = *first_;
    std::size_t size = 0;
    for (float& entry : stack_[0].entry) entry = 0;
    stack_[size++].ref = layout_.root;
    while (size > 0) {
      const WaitingNode& top = stack_[--size];
      const Ref ref = top.ref;
      unsigned active = 0;
      for (int part = 0; part < kParts; ++part) {
        const int lane = part * kLanes;
        const auto here = hn::Le(hn::Load(kFloats, top.entry + lane), hn::Load(kFloats, limit_ + lane));
        active |= bits_of(here) << lane;
        hn::Store(hn::Add(hn::Load(kFloats, visited_ + lane), hn::IfThenElseZero(here, hn::Set(kFloats, 1.0f))),
                  kFloats, visited_ + lane);
      }
      if (active == 0) continue;
      if (is_leaf(ref)) {
        visit_leaf(ref, active);
      } else {
        size = push_children(layout_.nodes[ref], first, size);
      }
    }
    for (std::size_t i = 0; i < tasks_.size(); ++i) tasks_[i].cost->nodes += static_cast<std::uint32_t>(visited_[i]);
  }

  /// The children that some ray may meet, by the bounds of all rays' numbers: rounding preserves order, so none is
  /// lost. Tests eight children at once, before single rays are tested child by child. Bit k is the k-th child in the
  /// order of the walk.
  /// source  interval arithmetic for packets: Boulos, Wald, Shirley, "Geometric and Arithmetic Culling Methods for
  /// Entire Ray Packets", University of Utah, 2006
  HWY_INLINE unsigned maybe_met(const Node& node, const RayFrame& first, std::uint32_t order) const {
    unsigned maybe = 0;
    Lanes limit = hn::MaxOfLanes(kFloats, hn::Load(kFloats, limit_));
    for (int part = 1; part < kParts; ++part) {
      limit = hn::Max(limit, hn::MaxOfLanes(kFloats, hn::Load(kFloats, limit_ + part * kLanes)));
    }
    for (int part = 0; part < kParts; ++part) {
      const int lane = part * kLanes;
      Lanes near[3];
      Lanes far[3];
      for (int axis = 0; axis < 3; ++axis) {
        const Lanes least = hn::Set(kFloats, least_inverse_[axis]);
        const Lanes most = hn::Set(kFloats, most_inverse_[axis]);
        const Lanes near_plane = hn::Load(kFloats, plane(node, first.near_plane[axis]) + lane);
        const Lanes far_plane = hn::Load(kFloats, plane(node, first.far_plane[axis]) + lane);
        const Lanes near_offset = hn::Set(kFloats, most_near_offset_[axis]);
        const Lanes far_offset = hn::Set(kFloats, least_far_offset_[axis]);
        near[axis] = hn::Min(hn::MulSub(near_plane, least, near_offset), hn::MulSub(near_plane, most, near_offset));
        far[axis] = hn::Max(hn::MulSub(far_plane, least, far_offset), hn::MulSub(far_plane, most, far_offset));
      }
      const Lanes enter = hn::Max(hn::Max(near[0], near[1]), hn::Max(near[2], hn::Zero(kFloats)));
      const Lanes leave = hn::Min(hn::Min(far[0], far[1]), hn::Min(far[2], limit));
      if constexpr (kLanes == kWidth) {
        const auto places = hn::IndicesFromVec(kFloats, places_in(order));
        return bits_of(hn::Le(hn::TableLookupLanes(enter, places), hn::TableLookupLanes(leave, places)));
      }
      maybe |= bits_of(hn::Le(enter, leave)) << lane;
    }
    unsigned ordered = 0;
    for (unsigned i = 0; i < kWidth; ++i) ordered |= (maybe >> (order >> (3 * i) & 7u) & 1u) << i;
    return ordered;
  }

  /// Pushes the children that some ray meets, the next on top, in the order of each single ray.
  HWY_INLINE std::size_t push_children(const Node& node, const RayFrame& first, std::size_t size) {
    const std::uint32_t order = kGoal == Goal::any ? node.occlusion_order() : node.order[first.octant];
    for (unsigned rest = maybe_met(node, first, order); rest != 0;) {
      const int place = std::bit_width(rest) - 1;
      rest ^= 1u << place;
      const unsigned child = order >> (3 * place) & 7u;
      WaitingNode& waiting = stack_[size];
      bool is_met = false;
      for (int part = 0; part < kParts; ++part) {
        const int lane = part * kLanes;
        Lanes near[3];
        Lanes far[3];
        for (int axis = 0; axis < 3; ++axis) {
          const Lanes inverse = hn::Load(kFloats, inverse_[axis] + lane);
          near[axis] = hn::MulSub(hn::Set(kFloats, plane(node, first.near_plane[axis])[child]), inverse,
                                  hn::Load(kFloats, near_offset_[axis] + lane));
          far[axis] = hn::MulSub(hn::Set(kFloats, plane(node, first.far_plane[axis])[child]), inverse,
                                 hn::Load(kFloats, far_offset_[axis] + lane));
        }
        const Lanes enter = hn::Max(hn::Max(near[0], near[1]), hn::Max(near[2], hn::Zero(kFloats)));
        const Lanes leave = hn::Min(hn::Min(far[0], far[1]), hn::Min(far[2], hn::Load(kFloats, limit_ + lane)));
        const auto met = hn::Le(enter, leave);
        constexpr float kNever = std::numeric_limits<float>::infinity();
        hn::Store(hn::IfThenElse(met, enter, hn::Set(kFloats, kNever)), kFloats, waiting.entry + lane);
        is_met = is_met || !hn::AllFalse(kFloats, met);
      }
      waiting.ref = node.child[child];
      if (!is_met) continue;
      fetch(layout_.nodes.data(), layout_.leaves.data(), waiting.ref);
      ++size;
    }
    return size;
  }

  /// Tests each active ray against the leaf's triangles.
  HWY_INLINE void visit_leaf(Ref ref, unsigned active) {
    const Leaf& leaf = layout_.leaves[ref & kIndexMask];
    const unsigned present = (2u << (leaf_count(ref) - 1)) - 1;
    for (; active != 0; active &= active - 1) {
      const auto i = static_cast<std::size_t>(__builtin_ctz(active));
      const RayFrame& ray = ray_[i];
      WalkReach& reach = reach_[i];
      const TriangleTest<kCorners> test(leaf, ray);
      const unsigned met = test.met(reach.local < ray.parameter_cap ? reach.local : ray.parameter_cap) & present;
      if (met == 0) continue;
      WalkCost& cost = *tasks_[i].cost;
      if constexpr (kGoal == Goal::any) {
        const unsigned sure = test.sure_within(sure_limit_[i]);
        const std::uint32_t found =
            first_met<kCorners>(call_of(i), ray, leaf, met, sure, reach, cost, tasks_[i].corners);
        tasks_[i].met = found;
        if (found != Bvh::kNoTriangle) reach.local = -1;
      } else {
        sure_hits_[i].template visit<kCorners>(call_of(i), ray, leaf, test, met, reach, cost);
      }
      limit_[i] = reach.is_over() ? -1 : std::min(reach.local, limit_[i]);
    }
  }

  const Layout& layout_;
  const TriangleMesh& mesh_;
  std::span<Bvh::RayTask> tasks_;
  const RayFrame* first_ = nullptr;  // the first ray in progress; all agree on its octant
  bool is_under_way_[kWidth];
  HWY_ALIGN float inverse_[3][kWidth];
  HWY_ALIGN float near_offset_[3][kWidth];
  HWY_ALIGN float far_offset_[3][kWidth];
  float least_inverse_[3];  // over all rays, like the following three
  float most_inverse_[3];
  float most_near_offset_[3];
  float least_far_offset_[3];
  HWY_ALIGN float limit_[kWidth];    // -1: the ray is done
  HWY_ALIGN float visited_[kWidth];  // nodes visited by each ray; far below 2^24, so floats count exactly
  float sure_limit_[kWidth];
  RayFrame ray_[kWidth];
  WalkReach reach_[kWidth];
  SureHits sure_hits_[kWidth];
  WaitingNode stack_[kStackSize + kWidth];
};

template <Goal kGoal, bool kCorners>
void walk_packets(const Layout& layout, std::span<Bvh::RayTask> tasks, const TriangleMesh& mesh) {
  Packet<kGoal, kCorners> packet(layout, mesh);
  for (std::size_t begin = 0; begin < tasks.size(); begin += kWidth) {
    const auto some = tasks.subspan(begin, std::min<std::size_t>(kWidth, tasks.size() - begin));
    if (!packet.walk(some)) walk_rays_in_turn(layout, some, mesh, kGoal);
  }
}

void WalkPackets(const Layout& layout, std::span<Bvh::RayTask> tasks, const TriangleMesh& mesh, Goal goal) {
  if (goal == Goal::any) {
    layout.has_corners ? walk_packets<Goal::any, true>(layout, tasks, mesh)
                       : walk_packets<Goal::any, false>(layout, tasks, mesh);
  } else {
    layout.has_corners ? walk_packets<Goal::nearest, true>(layout, tasks, mesh)
                       : walk_packets<Goal::nearest, false>(layout, tasks, mesh);
  }
}

}  // namespace collided::engine::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace collided::engine::bvh {

HWY_EXPORT(WalkPackets);

void walk_ray_packets(const Layout& layout, std::span<Bvh::RayTask> tasks, const TriangleMesh& mesh,
                      Bvh::RayGoal goal) {
  HWY_DYNAMIC_DISPATCH(WalkPackets)(layout, tasks, mesh, goal);
}

namespace {

/// True if neighbours in the batch start close to each other, relative to the scene, and point in the same direction:
/// then they visit the same nodes.
bool is_alike(const Layout& layout, const Ray& a, const Ray& b) {
  constexpr double kClose = 0x1p-7;
  const double along = a.direction.dot(b.direction);
  const bool same_direction =
      along > 0 && along * along > 0.998 * a.direction.squaredNorm() * b.direction.squaredNorm();
  return same_direction && ((a.origin - b.origin) * layout.frame.scale).cwiseAbs().maxCoeff() < kClose;
}

/// A cheap estimate from the first few rays.
bool is_coherent(const Layout& layout, std::span<const Bvh::RayTask> tasks) {
  constexpr std::size_t kLooks = 16;
  if (tasks.size() < kLooks) return false;
  std::size_t alike = 0;
  for (std::size_t i = 1; i < kLooks; ++i) alike += is_alike(layout, *tasks[i - 1].ray, *tasks[i].ray) ? 1 : 0;
  return alike > 3 * kLooks / 4;
}

}  // namespace

void walk_rays(const Layout& layout, std::span<Bvh::RayTask> tasks, const TriangleMesh& mesh, Bvh::RayGoal goal) {
  if (goal != Bvh::RayGoal::every && is_coherent(layout, tasks)) {
    walk_ray_packets(layout, tasks, mesh, goal);
  } else {
    walk_rays_in_turn(layout, tasks, mesh, goal);
  }
}

}  // namespace collided::engine::bvh
#endif
