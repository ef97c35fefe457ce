#pragma once

#include <cstdint>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "server/geometry/ray.hpp"

namespace collided::oracle {
using namespace engine;

/// Where a node's boxes are parted: at the middle one along the longest axis, or where the surfaces of the two halves
/// times their numbers are least, of all places on all axes.
enum class SplitRule { median, surface_area };

/// A binary tree of boxes over boxes, nothing but the rule by which it was cut.
/// source  Goldsmith, Salmon, "Automatic Creation of Object Hierarchies for Ray Tracing", 1987
class SplitTree {
 public:
  static constexpr std::size_t kLeafBoxes = 3;

  SplitTree(std::vector<Aabb> boxes, SplitRule rule);

  /// Nodes that an endless ray visits, leaves included: all whose box it meets.
  std::uint64_t visited(const Ray& ray) const;
  /// Sorted numbers of the boxes that it meets.
  std::vector<std::uint32_t> met(const Ray& ray) const;

 private:
  struct Node {
    Aabb bounds;
    std::uint32_t begin = 0;
    std::uint32_t end = 0;
    std::uint32_t children = 0;  // the first of two; 0: a leaf
  };

  void split(std::uint32_t node, SplitRule rule);
  std::uint32_t cut_in_half(const Node& node);
  std::uint32_t cut_by_surface(const Node& node);
  void sort(const Node& node, int axis);
  template <class Leaf>
  std::uint64_t walk(const Ray& ray, Leaf leaf) const;

  std::vector<Aabb> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// Whether an endless ray meets a box, in plain double; half the surface of a box.
bool ray_meets(const Ray& ray, const Aabb& box);
double half_area_m2(const Aabb& box);

}  // namespace collided::oracle
