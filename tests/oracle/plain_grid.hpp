#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "server/geometry/aabb.hpp"

namespace collided::oracle {
using namespace engine;

/// The lecture's grid with one size of cell: cells, found by a hash of their place, know their boxes. A pair that shares
/// several cells counts in the one of its common low corner. Finite boxes, at most 2^20 cells from the origin.
class PlainGrid {
 public:
  explicit PlainGrid(double cell_m) : cell_m_(cell_m) {}

  /// Calls found(i, j), i < j, once for each two boxes that overlap.
  template <class Found>
  void pairs(const std::vector<Aabb>& boxes, Found found) {
    cells_.clear();
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      const Cell low = cell(boxes[i].low), high = cell(boxes[i].high);
      for (std::int64_t x = low.x; x <= high.x; ++x) {
        for (std::int64_t y = low.y; y <= high.y; ++y) {
          for (std::int64_t z = low.z; z <= high.z; ++z) enter(boxes, i, {x, y, z}, found);
        }
      }
    }
  }

 private:
  struct Cell {
    std::int64_t x, y, z;
    bool operator==(const Cell&) const = default;
  };

  Cell cell(const Vec3& p) const {
    const auto place = [&](double x) { return static_cast<std::int64_t>(std::floor(x / cell_m_)); };
    return {place(p[0]), place(p[1]), place(p[2])};
  }
  static std::uint64_t key(const Cell& c) {
    constexpr std::int64_t kMiddle = 1 << 20;
    return static_cast<std::uint64_t>(((c.x + kMiddle) << 42) | ((c.y + kMiddle) << 21) | (c.z + kMiddle));
  }
  /// Meets those that are in the cell already, and stays in it.
  template <class Found>
  void enter(const std::vector<Aabb>& boxes, std::uint32_t i, const Cell& at, Found& found) {
    std::vector<std::uint32_t>& members = cells_[key(at)];
    for (const std::uint32_t j : members) {
      if (overlaps(boxes[i], boxes[j]) && cell(boxes[i].low.cwiseMax(boxes[j].low)) == at) found(j, i);
    }
    members.push_back(i);
  }

  double cell_m_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace collided::oracle
