#include "server/intake/growing_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "server/intake/space_order.hpp"

namespace collided {
namespace {

constexpr float kEndless = std::numeric_limits<float>::infinity();

float down(double value) {
  const auto rounded = static_cast<float>(value);
  return rounded > value ? std::nextafter(rounded, -kEndless) : rounded;
}
float up(double value) { return -down(-value); }

}  // namespace

GrowingTree::Box GrowingTree::box_of(const Aabb& bounds) const {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    // The difference is rounded to double first, which the step outward covers.
    const double from = bounds.low[axis] - origin_[axis];
    const double to = bounds.high[axis] - origin_[axis];
    box.low[axis] = down(from - std::abs(from) * 0x1p-52);
    box.high[axis] = up(to + std::abs(to) * 0x1p-52);
  }
  return box;
}

void GrowingTree::extend(Box& box, const Box& more) {
  box.low = box.low.min(more.low);
  box.high = box.high.max(more.high);
}

bool GrowingTree::contains(const Box& box, const Box& inner) {
  return ((box.low <= inner.low) && (inner.high <= box.high)).all();
}

bool GrowingTree::overlaps(const Box& a, const Box& b) { return ((a.low <= b.high) && (b.low <= a.high)).all(); }

void GrowingTree::build(const std::vector<Vec3>& vertices, const std::vector<TriangleCorners>& corners,
                        const std::vector<std::uint32_t>& triangles) {
  std::vector<Vec3> places;
  Aabb all;
  for (const std::uint32_t triangle : triangles) all.extend(places.emplace_back(vertices[corners[triangle][0]]));
  origin_ = triangles.empty() ? Vec3::Zero() : Vec3(all.low / 2 + all.high / 2);
  order_.clear();
  for (const std::uint32_t number : space_order(places)) order_.push_back(triangles[number]);
  place_of_.resize(corners.size());
  own_boxes_.resize(order_.size());
  leaf_count_ = std::bit_ceil(static_cast<std::uint32_t>(order_.size() / kLeafTriangles + 1));
  const Box nothing{Eigen::Array3f::Constant(kEndless), Eigen::Array3f::Constant(-kEndless)};
  boxes_.assign(2 * std::size_t{leaf_count_}, nothing);
  for (std::uint32_t place = 0; place < order_.size(); ++place) {
    Aabb bounds;
    for (const std::uint32_t corner : corners[order_[place]]) bounds.extend(vertices[corner]);
    place_of_[order_[place]] = place;
    own_boxes_[place] = box_of(bounds);
    extend(boxes_[leaf_count_ + place / kLeafTriangles], own_boxes_[place]);
  }
  for (std::uint32_t node = leaf_count_ - 1; node > 0; --node) {
    extend(boxes_[node], boxes_[2 * std::size_t{node}]);
    extend(boxes_[node], boxes_[2 * std::size_t{node} + 1]);
  }
}

void GrowingTree::update(std::uint32_t triangle, const Aabb& bounds) {
  const std::uint32_t place = place_of_[triangle];
  const Box box = own_boxes_[place] = box_of(bounds);
  for (std::uint32_t node = leaf_count_ + place / kLeafTriangles; node > 0 && !contains(boxes_[node], box); node /= 2) {
    extend(boxes_[node], box);
  }
}

void GrowingTree::find(const Aabb& bounds, std::vector<std::uint32_t>& found) const {
  const Box asked = box_of(bounds);
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
    for (std::size_t place = first; place < end; ++place) {
      if (overlaps(own_boxes_[place], asked)) found.push_back(order_[place]);
    }
  }
}

}  // namespace collided
