#include "server/intake/simplify/growing_tree.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "server/intake/simplify/space_order.hpp"

namespace collided::engine {
namespace {

/// A float below the value, by at most 2^-22 of it: 2^-23 of it is subtracted, of which rounding adds back at most
/// half.
float down(double value) {
  constexpr double kFloatStep = 0x1p-23;
  constexpr double kBelowFloats = 0x1p-140;
  const auto lower = static_cast<float>(value - (std::abs(value) * kFloatStep + kBelowFloats));
  return std::min(lower, std::numeric_limits<float>::max());
}
float up(double value) { return -down(-value); }

}  // namespace

GrowingTree::Box GrowingTree::box_of(const Aabb& bounds) const {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    // The difference is rounded to double first; the step outward is larger than that error.
    box.low[axis] = down(bounds.low[axis] - origin_[axis]);
    box.high[axis] = up(bounds.high[axis] - origin_[axis]);
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
  boxes_.assign(2 * std::size_t{leaf_count_}, Box{});
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

void GrowingTree::find(std::span<const Aabb> asked, std::vector<Meeting>& found) {
  asked_.clear();
  Box all;
  for (const Aabb& bounds : asked) extend(all, asked_.emplace_back(box_of(bounds)));
  std::array<std::uint32_t, 64> waiting;
  std::size_t waiting_count = 0;
  if (!order_.empty() && overlaps(boxes_[1], all)) waiting[waiting_count++] = 1;
  while (waiting_count > 0) {
    const std::uint32_t node = waiting[--waiting_count];
    if (node >= leaf_count_) {
      find_in_leaf(node - leaf_count_, all, found);
      continue;
    }
    waiting[waiting_count] = 2 * node;
    waiting_count += overlaps(boxes_[2 * std::size_t{node}], all) ? 1 : 0;
    waiting[waiting_count] = 2 * node + 1;
    waiting_count += overlaps(boxes_[2 * std::size_t{node} + 1], all) ? 1 : 0;
  }
}

void GrowingTree::find_in_leaf(std::uint32_t leaf, const Box& all, std::vector<Meeting>& found) const {
  const std::size_t first = std::size_t{leaf} * kLeafTriangles;
  const std::size_t end = std::min(first + kLeafTriangles, order_.size());
  for (std::size_t place = first; place < end; ++place) {
    if (!overlaps(own_boxes_[place], all)) continue;
    for (std::uint32_t i = 0; i < asked_.size(); ++i) {
      if (overlaps(own_boxes_[place], asked_[i])) found.push_back({i, order_[place]});
    }
  }
}

}  // namespace collided::engine
