#pragma once

#include <memory>
#include <vector>

#include "server/broad_phase/hierarchy/box_tree.hpp"
#include "server/world/objects/object.hpp"

namespace collided::engine {

/// The loaded scenes in order of loading, with a tree over their bounds if there are many. Immutable; copies share the
/// content.
class SceneList {
 public:
  using Scenes = std::vector<std::shared_ptr<const StaticScene>>;

  SceneList() = default;
  explicit SceneList(Scenes scenes);

  Scenes::const_iterator begin() const { return held_->scenes.begin(); }
  Scenes::const_iterator end() const { return held_->scenes.end(); }
  std::size_t size() const { return held_->scenes.size(); }
  bool empty() const { return held_->scenes.empty(); }
  const std::shared_ptr<const StaticScene>& operator[](std::size_t index) const { return held_->scenes[index]; }
  bool operator==(const SceneList&) const = default;

  /// Calls visit(index) for the scenes that a ray may meet at s in [0, limit], from near to far if there are many.
  /// visit returns the new limit; a negative one ends the walk.
  template <class Visit>
  void walk_ray(const Ray& ray, double limit, WalkCost& cost, const Visit& visit) const {
    if (held_->tree) {
      const auto found = [&](std::uint32_t index, double) { return visit(index); };
      return held_->tree->walk_ray(ray, limit, found, cost);
    }
    for (std::size_t i = 0; i < size() && limit >= 0; ++i) limit = visit(i);
  }
  /// Calls visit(index) for the scenes that may be within sqrt(limit_m2) of a point.
  template <class Visit>
  void walk_near(const Vec3& point, double limit_m2, WalkCost& cost, const Visit& visit) const {
    if (held_->tree) {
      const auto found = [&](std::uint32_t index, double) { return visit(index); };
      return held_->tree->walk_near(point, limit_m2, found, cost);
    }
    for (std::size_t i = 0; i < size() && limit_m2 >= 0; ++i) limit_m2 = visit(i);
  }
  /// Calls visit(index) for the scenes that a box may meet. visit returns false to end the walk.
  template <class Visit>
  void walk_box(const Aabb& box, WalkCost& cost, const Visit& visit) const {
    if (held_->tree) {
      const auto found = [&](std::uint32_t index) { return visit(index); };
      return held_->tree->walk_box(box, found, cost);
    }
    for (std::size_t i = 0; i < size(); ++i) {
      if (!visit(i)) return;
    }
  }
  /// True if there are enough scenes for a tree; else each is tested.
  bool are_many() const { return held_->tree != nullptr; }

 private:
  struct Listed {
    Scenes scenes;
    std::unique_ptr<const BoxTree> tree;  // its numbers are positions in the list
  };
  static const std::shared_ptr<const Listed>& nothing();

  std::shared_ptr<const Listed> held_ = nothing();
};

}  // namespace collided::engine
