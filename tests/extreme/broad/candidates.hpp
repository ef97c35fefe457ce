#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/broad_phase/grid/grid.hpp"
#include "server/broad_phase/hierarchy/bvh.hpp"
#include "tests/oracle/box_pairs.hpp"

namespace collided::extreme {
using namespace engine;

using Numbers = std::vector<std::uint32_t>;
using oracle::pairs_by_force;
using oracle::pairs_of;
using Pairs = oracle::BoxPairs;

inline Aabb cube(const Vec3& low, double size_m) { return {low, low + Vec3::Constant(size_m)}; }

inline Grid grid_of(const std::vector<Aabb>& boxes) {
  Grid grid;
  grid.rebuild(boxes);
  return grid;
}

inline std::uint64_t count_pairs(const Grid& grid) {
  std::uint64_t count = 0;
  WalkCost cost;
  const auto add = [&](std::uint32_t, std::uint32_t) {
    ++count;
    return true;
  };
  grid.pairs(add, cost);
  return count;
}

template <class Index>
Numbers in_box(const Index& index, const Aabb& asked) {
  Numbers all;
  WalkCost cost;
  index.walk_box(
      asked,
      [&](std::uint32_t number) {
        all.push_back(number);
        return true;
      },
      cost);
  std::sort(all.begin(), all.end());
  return all;
}

inline Numbers along_ray(const Grid& grid, const Ray& ray, double limit) {
  Numbers all;
  WalkCost cost;
  grid.walk_ray(
      ray, limit,
      [&](std::uint32_t number, double now) {
        all.push_back(number);
        return now;
      },
      cost);
  std::sort(all.begin(), all.end());
  return all;
}

/// A triangle may be offered twice; here once.
inline Numbers along_ray(const Bvh& tree, const Ray& ray) {
  Numbers all;
  WalkCost cost;
  tree.walk_ray(
      ray, ray.length_m, 0,
      [&](std::uint32_t number, double now) {
        all.push_back(number);
        return now;
      },
      cost);
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

inline Numbers near_point(const Grid& grid, const Vec3& point, double reach_m) {
  Numbers all;
  WalkCost cost;
  grid.walk_near(
      point, reach_m * reach_m,
      [&](std::uint32_t number, double now) {
        all.push_back(number);
        return now;
      },
      cost);
  std::sort(all.begin(), all.end());
  return all;
}

}  // namespace collided::extreme
