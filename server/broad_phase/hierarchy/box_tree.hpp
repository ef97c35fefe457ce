#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/ray.hpp"

namespace collided::engine {

struct BoxTreeNodes;  // box_tree.cpp

/// A tree over moving boxes, with the nodes of a Bvh, walked by the same code. Generous, never misses; visits each box
/// at most once per walk, roughly near to far.
/// threads  one rebuilds; while none does, any number may walk
class BoxTree {
 public:
  BoxTree();
  ~BoxTree();
  BoxTree(BoxTree&&) noexcept;
  BoxTree& operator=(BoxTree&&) noexcept;

  /// Boxes are numbered by their index in the span; empty ones are left out. Keeps its memory between calls. If the
  /// same boxes have moved a little, only refits the tree, which takes a tenth of the time.
  void rebuild(std::span<const Aabb> boxes);
  std::size_t bytes() const;

  /// Same as Bvh::walk_ray: s along the ray in units of its direction's length; `found` returns the new limit, and a
  /// negative one ends the walk.
  using RayFound = FunctionRef<double(std::uint32_t box, double limit)>;
  void walk_ray(const Ray& ray, double limit, RayFound found, WalkCost& cost) const;

  /// Same as Bvh::walk_near, with squared distances.
  using NearFound = FunctionRef<double(std::uint32_t box, double limit_m2)>;
  void walk_near(const Vec3& point, double limit_m2, NearFound found, WalkCost& cost) const;

  /// Visits the boxes that overlap the given one, touching included; `found` returns false to end the walk.
  using BoxFound = FunctionRef<bool(std::uint32_t box)>;
  void walk_box(const Aabb& asked, BoxFound found, WalkCost& cost) const;

 private:
  std::unique_ptr<BoxTreeNodes> nodes_;
};

}  // namespace collided::engine
