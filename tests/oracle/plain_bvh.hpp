#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "server/geometry/aabb.hpp"
#include "tests/oracle/first_hit.hpp"

namespace collided::oracle {
using namespace engine;

/// The lecture's first form: space is halved by planes across the axes until a cell meets at most three triangles. A
/// triangle on both sides of a plane is referred to from both. Where no plane parts anything, or at kMaxDepth, a leaf
/// holds more.
///
/// source  de Berg et al., "Computational Geometry", chapter 12; Fuchs, Kedem, Naylor, 1980
class PlainBvh {
 public:
  static constexpr std::size_t kLeafTriangles = 3;
  static constexpr int kMaxDepth = 40;

  explicit PlainBvh(const TriangleMesh& mesh);

  FirstHit first_hit(const Ray& ray, PlainCost& cost) const;

  std::size_t references() const { return references_.size(); }
  std::size_t nodes() const { return nodes_.size(); }
  int depth() const { return depth_; }
  std::size_t bytes() const { return nodes_.size() * sizeof(Node) + references_.size() * sizeof(std::uint32_t); }
  std::size_t largest_leaf() const { return largest_leaf_; }

 private:
  struct Node {
    int axis = -1;  // -1: a leaf
    double plane = 0;
    std::uint32_t first = 0;   // child below, or first reference
    std::uint32_t second = 0;  // child above, or number of references
  };
  struct Walk;

  std::uint32_t build(std::vector<std::uint32_t> triangles, int depth);
  std::uint32_t leaf(const std::vector<std::uint32_t>& triangles);
  void walk(Walk& walk, std::uint32_t node, double from, double to) const;

  const TriangleMesh& mesh_;
  std::vector<Aabb> boxes_;  // of the triangles, while the tree is built
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> references_;
  std::size_t largest_leaf_ = 0;
  int depth_ = 0;
};

}  // namespace collided::oracle
