#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "server/world/objects/scene_list.hpp"

namespace collided::engine {

// The walk of rays through static scenes, one by one or together: of plain rays (plain_rays.cpp) and of all others
// (ray_question.cpp). These differ in their triangle tests and in where they keep hits.

/// The walk's view of a ray in progress. Copied: it refers to the ray's memory.
template <class Walker>
concept RayWalker = requires(const Walker& walker, const StaticScene& scene, const Triangle& corners) {
  { walker.ray() } -> std::same_as<const Ray&>;
  { walker.limit() } -> std::same_as<double>;  // in lengths of the direction; negative: the search is over
  { walker.cost() } -> std::same_as<WalkCost&>;
  { walker.goal(std::size_t{}) } -> std::same_as<Bvh::RayGoal>;               // in the scene of that index
  { walker.offer(scene, std::uint32_t{}, corners) } -> std::same_as<double>;  // tests a triangle; returns the new limit
  { walker.wants_hits() } -> std::same_as<bool>;  // false: a certain hit goes to take(), untested
  walker.take(scene, std::uint32_t{});
};

/// Most rays that are walked together.
inline constexpr std::size_t kRaysAtOnce = 64;

/// Takes the candidates of one ray's walk through one scene.
template <RayWalker Walker>
struct SceneCandidate {
  // Without default values: a group's members would be written twice.
  Walker of;
  const StaticScene* scene;

  double operator()(std::uint32_t triangle, const Triangle& corners, double) const {
    return of.offer(*scene, triangle, corners);
  }
  /// Takes the triangle at which a walk in mode `any` ended, unless it was a candidate before. It is certainly hit, so
  /// only the members of the hit remain to be computed.
  void meet(std::uint32_t triangle, const Triangle& corners) const {
    if (triangle == Bvh::kNoTriangle || of.limit() < 0) return;
    if (of.wants_hits()) of.offer(*scene, triangle, corners);
    else of.take(*scene, triangle);
  }
};

template <RayWalker Walker>
inline void walk_scene(const Walker& walker, const StaticScene& scene, Bvh::RayGoal goal) {
  const SceneCandidate<Walker> candidate{walker, &scene};
  const Bvh& tree = scene.tree;
  switch (goal) {
    case Bvh::RayGoal::every:
      return tree.walk_ray(walker.ray(), walker.limit(), 0, scene.mesh, candidate, walker.cost());
    case Bvh::RayGoal::nearest:
      return tree.walk_ray_nearest(walker.ray(), walker.limit(), scene.mesh, candidate, walker.cost());
    case Bvh::RayGoal::any: {
      Triangle corners;
      const std::uint32_t met =
          tree.meet_ray(walker.ray(), walker.limit(), scene.mesh, candidate, walker.cost(), corners);
      return candidate.meet(met, corners);
    }
  }
}

template <RayWalker Walker>
inline void walk_scenes(const Walker& walker, const SceneList& scenes) {
  if (walker.limit() < 0) return;
  scenes.walk_ray(walker.ray(), walker.limit(), walker.cost(), [&](std::size_t index) {
    walk_scene(walker, *scenes[index], walker.goal(index));
    return walker.limit();
  });
}

/// Walks rays through one scene together, except those with another goal than the first.
///
/// tasks  memory, one per ray
template <RayWalker Walker>
void walk_scene_together(std::span<const Walker> walkers, const SceneList& scenes, std::size_t index,
                         std::span<Bvh::RayTask> tasks) {
  std::array<SceneCandidate<Walker>, kRaysAtOnce> candidates;
  const StaticScene& scene = *scenes[index];
  const Bvh::RayGoal goal = walkers.front().goal(index);
  std::size_t count = 0;
  for (const Walker& walker : walkers) {
    if (walker.limit() < 0) continue;
    if (walker.goal(index) != goal) {
      walk_scene(walker, scene, walker.goal(index));
      continue;
    }
    candidates[count] = {walker, &scene};
    Bvh::RayTask& task = tasks[count];
    task.ray = &walker.ray();
    task.limit = walker.limit();
    task.candidate = candidates[count];
    task.cost = &walker.cost();
    task.met = Bvh::kNoTriangle;
    ++count;
  }
  scene.tree.walk_rays(tasks.first(count), scene.mesh, goal);
  if (goal != Bvh::RayGoal::any) return;
  for (std::size_t i = 0; i < count; ++i) candidates[i].meet(tasks[i].met, tasks[i].corners);
}

/// walkers  up to kRaysAtOnce
/// tasks    memory, one per ray
template <RayWalker Walker>
void walk_scenes_together(std::span<const Walker> walkers, const SceneList& scenes, std::span<Bvh::RayTask> tasks) {
  if (walkers.empty()) return;
  if (scenes.are_many()) {
    for (const Walker& walker : walkers) walk_scenes(walker, scenes);
    return;
  }
  for (std::size_t index = 0; index < scenes.size(); ++index) walk_scene_together(walkers, scenes, index, tasks);
}

}  // namespace collided::engine
