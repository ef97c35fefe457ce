#include "server/world/boxes_only.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/world/question_shapes.hpp"
#include "server/world/snapshot.hpp"

namespace collided::engine {
namespace {

using wire_contract::QueryKind;

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Where a line enters a box, in units of its direction's length; kNever where it does not. Plain slabs.
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

double distance2(const Vec3& point, const Aabb& box) {
  return (box.low - point).cwiseMax(point - box.high).cwiseMax(Vec3::Zero()).squaredNorm();
}

/// The least of some measure over the boxes that a walk offers.
template <class Measure>
struct Least {
  const Snapshot& snapshot;
  const StaticScene* scene;
  Measure measure;
  double best;

  static double triangle(void* raw, std::uint32_t number, double) {
    Least& self = *static_cast<Least*>(raw);
    self.best = std::min(self.best, self.measure(bounds(self.scene->mesh.triangle(number))));
    return self.best;
  }
  static double object(void* raw, std::uint32_t slot, double) {
    Least& self = *static_cast<Least*>(raw);
    self.best = std::min(self.best, self.measure(self.snapshot.bounds[slot]));
    return self.best;
  }
};

template <class Measure, class WalkTree, class WalkGrid>
double least(const Snapshot& snapshot, double limit, Measure&& measure, WalkTree&& walk_tree, WalkGrid&& walk_grid) {
  Least<Measure&> least{snapshot, nullptr, measure, limit};
  for (const auto& scene : snapshot.scenes) {
    least.scene = scene.get();
    walk_tree(scene->tree, least.best, &Least<Measure&>::triangle, &least);
  }
  if (snapshot.grid) walk_grid(*snapshot.grid, least.best, &Least<Measure&>::object, &least);
  return least.best;
}

std::optional<double> ray_distance(const Snapshot& snapshot, const double* n) {
  const Ray ray = ray_of(n);
  const double length_m = ray.direction.stableNorm();
  const double limit = n[6] / length_m;
  WalkCost cost;
  // A little beyond the limit, so that a box at the very end is told from none.
  const double s = least(
      snapshot, std::nextafter(limit, kNever), [&](const Aabb& box) { return entry(ray, box); },
      [&](const BspTree& tree, double from, BspTree::RayCandidate call, void* context) {
        tree.walk_ray(ray, from, 0, call, context, cost);
      },
      [&](const Grid& grid, double from, Grid::RayFound call, void* context) {
        grid.walk_ray(ray, from, call, context, cost);
      });
  return s <= limit && s < kNever ? std::optional(s * length_m) : std::nullopt;
}

std::optional<double> near_distance(const Snapshot& snapshot, const double* n) {
  const Vec3 point = point_of(n);
  const double limit = n[3] * n[3];
  WalkCost cost;
  const double square = least(
      snapshot, std::nextafter(limit, kNever), [&](const Aabb& box) { return distance2(point, box); },
      [&](const BspTree& tree, double from, BspTree::NearCandidate call, void* context) {
        tree.walk_near(point, from, 0, call, context, cost);
      },
      [&](const Grid& grid, double from, Grid::NearFound call, void* context) {
        grid.walk_near(point, from, call, context, cost);
      });
  return square <= limit && square < kNever ? std::optional(std::sqrt(square)) : std::nullopt;
}

std::set<ObjectId> overlapping(const Snapshot& snapshot, const Aabb& asked) {
  struct Context {
    const Snapshot& snapshot;
    const StaticScene* scene;
    std::set<ObjectId> objects;
  } context{snapshot, nullptr, {}};
  WalkCost cost;
  for (const auto& scene : snapshot.scenes) {
    context.scene = scene.get();
    const auto triangle = [](void* raw, std::uint32_t number) {
      Context& c = *static_cast<Context*>(raw);
      c.objects.insert(c.scene->part_objects[c.scene->part_of(number)]);
      return true;
    };
    scene->tree.walk_box(asked, triangle, &context, cost);
  }
  const auto object = [](void* raw, std::uint32_t slot) {
    Context& c = *static_cast<Context*>(raw);
    c.objects.insert((*c.snapshot.objects)[slot]->id);
    return true;
  };
  if (snapshot.grid) snapshot.grid->walk_box(asked, object, &context, cost);
  return std::move(context.objects);
}

}  // namespace

BoxesAnswer answer_by_boxes(const Snapshot& snapshot, const Questions& question) {
  const double* n = question.numbers.data();
  switch (question.kind) {
    case QueryKind::ray:
      return {ray_distance(snapshot, n), {}};
    case QueryKind::near:
      return {near_distance(snapshot, n), {}};
    case QueryKind::sphere:
      return {std::nullopt, overlapping(snapshot, bounds(sphere_of(n)))};
    default:
      return {std::nullopt, overlapping(snapshot, bounds(box_of(n)))};
  }
}

}  // namespace collided::engine
