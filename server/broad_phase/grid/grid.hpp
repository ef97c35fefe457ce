#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/ray.hpp"

namespace collided::engine {

/// The boxes of all moving objects. A multi-level hashed grid finds their pairs: a box goes to the level of its size,
/// so one giant among dust costs nothing; few boxes are swept along one axis instead (sweep_and_prune.hpp). A tree
/// (box_tree.hpp) serves rays and distances from a point. Coordinates are unbounded. Generous, never misses; visits
/// each box at most once per walk.
/// threads  one rebuilds; while none does, any number may walk
class Grid {
 public:
  /// The use of the grid. Without questions it has no tree; a question is still answered by testing every box.
  enum class Use { pairs, questions };
  explicit Grid(Use use = Use::questions);
  ~Grid();
  Grid(Grid&&) noexcept;
  Grid& operator=(Grid&&) noexcept;

  /// Boxes are numbered by their index in the span; empty ones are left out. Keeps its memory between calls.
  void rebuild(std::span<const Aabb> boxes);
  /// Equivalent to rebuild(boxes) if `before` holds all boxes except the changed ones, which may be listed twice. A few
  /// changes are put into an index of their own over the one that `before` was built with, which is shared, not copied;
  /// so is the index of earlier changes. The cost depends on the number of changes, not of boxes. Many changes cause a
  /// rebuild. From then on the two must not be rebuilt or updated at the same time: they share memory for it.
  void update(const Grid& before, std::span<const Aabb> boxes, std::span<const std::uint32_t> changed);

  /// Number of boxes that are not empty.
  std::size_t size() const;
  /// True if there are so few boxes that they are swept instead.
  bool is_swept() const;
  std::size_t bytes() const;

  /// All pairs (first < second) of overlapping boxes, touching included, each once, in no particular order. `found`
  /// returns false to end the walk.
  using PairFound = FunctionRef<bool(std::uint32_t first, std::uint32_t second)>;
  void pairs(PairFound found, WalkCost& cost) const;

  /// Boxes that overlap the given one, touching included; `found` returns false to end the walk.
  using BoxFound = FunctionRef<bool(std::uint32_t box)>;
  void walk_box(const Aabb& asked, BoxFound found, WalkCost& cost) const;

  /// Same as Bvh::walk_ray: s along the ray in units of its direction's length; `found` returns the new limit.
  using RayFound = FunctionRef<double(std::uint32_t box, double limit)>;
  void walk_ray(const Ray& ray, double limit, RayFound found, WalkCost& cost) const;

  /// Same as Bvh::walk_near, with squared distances.
  using NearFound = FunctionRef<double(std::uint32_t box, double limit_m2)>;
  void walk_near(const Vec3& point, double limit_m2, NearFound found, WalkCost& cost) const;

 private:
  struct Storage;
  template <class Found, class WalkBase, class WalkOver>
  void walk_both(double limit, const Found& found, const WalkBase& walk_base, const WalkOver& walk_over) const;

  std::unique_ptr<Storage> storage_;
};

}  // namespace collided::engine
