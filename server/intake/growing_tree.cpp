#include "server/intake/growing_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace collided {
namespace {

constexpr float kEndless = std::numeric_limits<float>::infinity();

float down(double value) {
  const auto rounded = static_cast<float>(value);
  return rounded > value ? std::nextafter(rounded, -kEndless) : rounded;
}
float up(double value) { return -down(-value); }

/// The low 21 bits, two zeros after each.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1f00000000ffff;
  bits = (bits | bits << 16) & 0x1f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

}  // namespace

GrowingTree::Box GrowingTree::box_of(const Vec3& low, const Vec3& high) const {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    // The difference is rounded to double first, which the step outward covers.
    const double from = low[axis] - origin_[axis];
    const double to = high[axis] - origin_[axis];
    box.low[axis] = down(from - std::abs(from) * 0x1p-52);
    box.high[axis] = up(to + std::abs(to) * 0x1p-52);
  }
  return box;
}

void GrowingTree::extend(Box& box, const Box& more) {
  for (int axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], more.low[axis]);
    box.high[axis] = std::max(box.high[axis], more.high[axis]);
  }
}

bool GrowingTree::contains(const Box& box, const Box& inner) {
  bool all = true;
  for (int axis = 0; axis < 3; ++axis) all = all && box.low[axis] <= inner.low[axis] && inner.high[axis] <= box.high[axis];
  return all;
}

bool GrowingTree::overlaps(const Box& a, const Box& b) {
  bool all = true;
  for (int axis = 0; axis < 3; ++axis) all = all && a.low[axis] <= b.high[axis] && b.low[axis] <= a.high[axis];
  return all;
}

void GrowingTree::sort_by_place(const std::vector<Vec3>& vertices, const std::vector<TriangleCorners>& corners) {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
  const auto place = [&](std::uint32_t triangle) { return vertices[corners[triangle][0]]; };
  for (const std::uint32_t triangle : order_) {
    low = low.cwiseMin(place(triangle));
    high = high.cwiseMax(place(triangle));
  }
  origin_ = low / 2 + high / 2;
  const double largest = (high - low).maxCoeff();
  const double scale = largest > 0 && std::isfinite(largest) ? 0x1fffff / largest : 0;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  keys.reserve(order_.size());
  for (const std::uint32_t triangle : order_) {
    const Vec3 at = (place(triangle) - low) * scale;
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) key |= spread(static_cast<std::uint64_t>(std::clamp(at[axis], 0.0, 0x1fffff * 1.0))) << axis;
    keys.emplace_back(key, triangle);
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t i = 0; i < keys.size(); ++i) order_[i] = keys[i].second;
}

void GrowingTree::build(const std::vector<Vec3>& vertices, const std::vector<TriangleCorners>& corners,
                        const std::vector<std::uint32_t>& triangles) {
  order_ = triangles;
  sort_by_place(vertices, corners);
  leaf_of_.resize(corners.size());
  leaf_count_ = std::bit_ceil(static_cast<std::uint32_t>(order_.size() / kLeafTriangles + 1));
  const Box nothing{{kEndless, kEndless, kEndless}, {-kEndless, -kEndless, -kEndless}};
  boxes_.assign(2 * std::size_t{leaf_count_}, nothing);
  for (std::uint32_t i = 0; i < order_.size(); ++i) {
    const std::uint32_t leaf = leaf_count_ + i / kLeafTriangles;
    leaf_of_[order_[i]] = leaf;
    for (const std::uint32_t corner : corners[order_[i]]) extend(boxes_[leaf], box_of(vertices[corner], vertices[corner]));
  }
  for (std::uint32_t node = leaf_count_ - 1; node > 0; --node) {
    extend(boxes_[node], boxes_[2 * std::size_t{node}]);
    extend(boxes_[node], boxes_[2 * std::size_t{node} + 1]);
  }
}

void GrowingTree::extend(std::uint32_t triangle, const Vec3& point) {
  const Box more = box_of(point, point);
  for (std::uint32_t node = leaf_of_[triangle]; node > 0 && !contains(boxes_[node], more); node /= 2) {
    extend(boxes_[node], more);
  }
}

void GrowingTree::find(const Vec3& low, const Vec3& high, std::vector<std::uint32_t>& found) const {
  const Box asked = box_of(low, high);
  std::array<std::uint32_t, 64> waiting;
  std::size_t waiting_count = 0;
  if (!order_.empty()) waiting[waiting_count++] = 1;
  while (waiting_count > 0) {
    const std::uint32_t node = waiting[--waiting_count];
    if (!overlaps(boxes_[node], asked)) continue;
    if (node < leaf_count_) {
      waiting[waiting_count++] = 2 * node;
      waiting[waiting_count++] = 2 * node + 1;
      continue;
    }
    const std::size_t first = std::size_t{node - leaf_count_} * kLeafTriangles;
    const std::size_t end = std::min(first + kLeafTriangles, order_.size());
    found.insert(found.end(), order_.begin() + static_cast<std::ptrdiff_t>(first), order_.begin() + static_cast<std::ptrdiff_t>(end));
  }
}

}  // namespace collided
