#include "server/world/audit/boxes_only.hpp"

#include <algorithm>
#include <cmath>

#include "server/world/objects/snapshot.hpp"
#include "server/world/query/question_shapes.hpp"

namespace collided::engine {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Where a line enters a box, in units of its direction's length; kNever if it misses. Plain slab test.
double entry(const Ray& ray, const Aabb& box) {
  double near = 0;
  double far = kNever;
  for (int k = 0; k < 3; ++k) {
    if (ray.direction[k] == 0) {
      if (ray.origin[k] < box.low[k] || ray.origin[k] > box.high[k]) return kNever;
      continue;
    }
    const double a = (box.low[k] - ray.origin[k]) / ray.direction[k];
    const double b = (box.high[k] - ray.origin[k]) / ray.direction[k];
    near = std::max(near, std::min(a, b));
    far = std::min(far, std::max(a, b));
  }
  return near <= far ? near : kNever;
}

/// The squared distance from a point to a box.
double distance2(const Vec3& point, const Aabb& box) {
  return (box.low - point).cwiseMax(point - box.high).cwiseMax(Vec3::Zero()).squaredNorm();
}

/// The smallest value of `measure` over the boxes that the walks offer, or `limit`.
template <class Measure, class WalkTree, class WalkGrid>
double least(const Snapshot& snapshot, double limit, Measure&& measure, WalkTree&& walk_tree, WalkGrid&& walk_grid) {
  double best = limit;
  for (const auto& scene : snapshot.scenes) {
    const auto triangle = [&](std::uint32_t number, double) {
      return best = std::min(best, measure(bounds(scene->mesh.triangle(number))));
    };
    walk_tree(scene->tree, best, triangle);
  }
  const auto object = [&](std::uint32_t slot, double) { return best = std::min(best, measure(snapshot.bounds(slot))); };
  if (snapshot.grid) walk_grid(*snapshot.grid, best, object);
  return best;
}

std::optional<double> ray_distance(const Snapshot& snapshot, const double* n) {
  const Ray ray = ray_of(n);
  const double length_m = ray.direction.stableNorm();
  const double limit = n[6] / length_m;
  WalkCost cost;
  // A little beyond the limit, so that a box at the very end does not differ from no box.
  const double s = least(
      snapshot, std::nextafter(limit, kNever), [&](const Aabb& box) { return entry(ray, box); },
      [&](const Bvh& tree, double from, Bvh::RayCandidate call) { tree.walk_ray(ray, from, 0, call, cost); },
      [&](const Grid& grid, double from, Grid::RayFound call) { grid.walk_ray(ray, from, call, cost); });
  return s <= limit && s < kNever ? std::optional(s * length_m) : std::nullopt;
}

std::optional<double> near_distance(const Snapshot& snapshot, const double* n) {
  const Vec3 point = point_of(n);
  const double limit = n[3] * n[3];
  WalkCost cost;
  const double square = least(
      snapshot, std::nextafter(limit, kNever), [&](const Aabb& box) { return distance2(point, box); },
      [&](const Bvh& tree, double from, Bvh::NearCandidate call) { tree.walk_near(point, from, 0, call, cost); },
      [&](const Grid& grid, double from, Grid::NearFound call) { grid.walk_near(point, from, call, cost); });
  return square <= limit && square < kNever ? std::optional(std::sqrt(square)) : std::nullopt;
}

std::set<ObjectId> overlapping(const Snapshot& snapshot, const Aabb& asked) {
  std::set<ObjectId> objects;
  WalkCost cost;
  for (const auto& scene : snapshot.scenes) {
    const auto triangle = [&](std::uint32_t number) {
      objects.insert(scene->part_objects[scene->part_of(number)]);
      return true;
    };
    scene->tree.walk_box(asked, triangle, cost);
  }
  const auto object = [&](std::uint32_t slot) {
    objects.insert(snapshot.objects[slot]->id);
    return true;
  };
  if (snapshot.grid) snapshot.grid->walk_box(asked, object, cost);
  return objects;
}

}  // namespace

BoxesAnswer answer_by_boxes(const Snapshot& snapshot, const Questions& question) {
  const double* n = question.numbers.data();
  switch (question.kind) {
    case QuestionKind::ray: return {ray_distance(snapshot, n), {}};
    case QuestionKind::near: return {near_distance(snapshot, n), {}};
    case QuestionKind::sphere: return {std::nullopt, overlapping(snapshot, bounds(sphere_of(n)))};
    default: return {std::nullopt, overlapping(snapshot, bounds(box_of(n)))};
  }
}

}  // namespace collided::engine
