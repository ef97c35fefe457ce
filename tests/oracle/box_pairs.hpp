#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "server/broad_phase/hierarchy/bvh.hpp"
#include "server/geometry/aabb.hpp"

namespace collided::oracle {
using namespace engine;

using BoxPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// All pairs of boxes that an index tells, in ascending order, so that a pair told twice shows.
template <class Index>
BoxPairs pairs_of(const Index& index) {
  BoxPairs all;
  WalkCost cost;
  const auto collect = [&](std::uint32_t first, std::uint32_t second) {
    all.emplace_back(first, second);
    return true;
  };
  index.pairs(collect, cost);
  std::sort(all.begin(), all.end());
  return all;
}

/// By comparing each box with every other.
inline BoxPairs pairs_by_force(const std::vector<Aabb>& boxes) {
  BoxPairs all;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    for (std::uint32_t j = i + 1; j < boxes.size(); ++j) {
      if (!boxes[i].empty() && !boxes[j].empty() && overlaps(boxes[i], boxes[j])) all.emplace_back(i, j);
    }
  }
  return all;
}

}  // namespace collided::oracle
