#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/ray.hpp"

namespace collided::engine {

/// Multi-level hashed grid over bounding boxes: a box goes to the level of its size, so one giant among dust costs
/// nothing. A few boxes are swept along one axis instead (sweep_and_prune.hpp). Unbounded coordinates. Generous, never misses; each box is called at most once a walk.
/// One thread rebuilds; while nobody rebuilds, any number may walk.
class Grid {
 public:
  Grid();
  ~Grid();
  Grid(Grid&&) noexcept;
  Grid& operator=(Grid&&) noexcept;

  /// Boxes are numbered by their place in the span; empty ones are left out. Keeps its memory between calls.
  void rebuild(std::span<const Aabb> boxes);

  std::size_t size() const;
  /// They are few.
  bool is_swept() const;
  std::size_t bytes() const;

  /// All pairs (first < second) of overlapping boxes, touching included, each once, in no particular order. False ends
  /// the walk.
  using PairFound = FunctionRef<bool(std::uint32_t first, std::uint32_t second)>;
  void pairs(PairFound found, WalkCost& cost) const;

  /// False ends the walk.
  using BoxFound = FunctionRef<bool(std::uint32_t box)>;
  void walk_box(const Aabb& asked, BoxFound found, WalkCost& cost) const;

  /// As Bvh::walk_ray: s along the ray in units of its direction's length; returns the limit from then on.
  using RayFound = FunctionRef<double(std::uint32_t box, double limit)>;
  void walk_ray(const Ray& ray, double limit, RayFound found, WalkCost& cost) const;

  /// As Bvh::walk_near, squares of distances.
  using NearFound = FunctionRef<double(std::uint32_t box, double limit_m2)>;
  void walk_near(const Vec3& point, double limit_m2, NearFound found, WalkCost& cost) const;

 private:
  struct Storage;
  std::unique_ptr<Storage> storage_;
};

}  // namespace collided::engine
