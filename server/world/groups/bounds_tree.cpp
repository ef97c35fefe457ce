#include "server/world/groups/bounds_tree.hpp"

#include "server/geometry/tolerance.hpp"

namespace collided::engine {

double least_clearance(const Aabb& a, const Aabb& b) {
  const Vec3 gap = (a.low - b.high).cwiseMax(b.low - a.high);
  const double widest_m = gap.maxCoeff();
  if (widest_m <= 0) return widest_m * (1 + kBoundSlack);
  return gap.cwiseMax(0).norm() * (1 - kBoundSlack);
}

BoundsTree::BoundsTree(std::span<const Aabb> boxes) {
  std::vector<std::uint32_t> numbers;
  numbers.reserve(boxes.size());
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    if (!boxes[i].empty()) numbers.push_back(i);
  }
  if (numbers.empty()) return;
  nodes_.reserve(2 * numbers.size());
  build(boxes, numbers);
}

std::uint32_t BoundsTree::build(std::span<const Aabb> boxes, std::span<std::uint32_t> numbers) {
  const auto own = static_cast<std::uint32_t>(nodes_.size());
  Aabb all;
  Aabb middles;
  // Unbounded boxes have no middle; they count as lying at the origin.
  const auto middle = [&](std::uint32_t number) -> Vec3 {
    const Vec3 sum = 0.5 * boxes[number].low + 0.5 * boxes[number].high;
    return sum.array().isFinite().select(sum, 0);
  };
  for (const std::uint32_t number : numbers) {
    all.extend(boxes[number]);
    middles.extend(middle(number));
  }
  nodes_.push_back({.bounds = all, .first = numbers.front()});
  if (numbers.size() == 1) return own;
  Eigen::Index axis = 0;
  (middles.high - middles.low).maxCoeff(&axis);
  const std::size_t half = numbers.size() / 2;
  std::nth_element(numbers.begin(), numbers.begin() + static_cast<std::ptrdiff_t>(half), numbers.end(),
                   [&](std::uint32_t x, std::uint32_t y) {
                     const double at_x = middle(x)[axis];
                     const double at_y = middle(y)[axis];
                     return at_x != at_y ? at_x < at_y : x < y;
                   });
  const std::uint32_t first = build(boxes, numbers.first(half));
  const std::uint32_t second = build(boxes, numbers.subspan(half));
  nodes_[own].first = first;
  nodes_[own].second = second;
  return own;
}

}  // namespace collided::engine
