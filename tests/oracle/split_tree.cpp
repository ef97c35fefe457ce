#include "tests/oracle/split_tree.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

namespace collided::oracle {
using namespace engine;

bool ray_meets(const Ray& ray, const Aabb& box) {
  double first = 0;
  double last = std::numeric_limits<double>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = 1 / ray.direction[axis];
    const double low = (box.low[axis] - ray.origin[axis]) * inverse;
    const double high = (box.high[axis] - ray.origin[axis]) * inverse;
    first = std::max(first, std::min(low, high));
    last = std::min(last, std::max(low, high));
  }
  return first <= last;
}

double half_area_m2(const Aabb& box) {
  if (box.empty()) return 0;
  const Vec3 size = box.high - box.low;
  return size[0] * (size[1] + size[2]) + size[1] * size[2];
}

SplitTree::SplitTree(std::vector<Aabb> boxes, SplitRule rule) : boxes_(std::move(boxes)), order_(boxes_.size()) {
  std::iota(order_.begin(), order_.end(), 0u);
  Node root{.bounds = {}, .begin = 0, .end = static_cast<std::uint32_t>(boxes_.size())};
  for (const Aabb& box : boxes_) root.bounds.extend(box);
  nodes_.push_back(root);
  split(0, rule);
}

void SplitTree::sort(const Node& node, int axis) {
  std::sort(order_.begin() + node.begin, order_.begin() + node.end, [&](std::uint32_t a, std::uint32_t b) {
    return boxes_[a].low[axis] + boxes_[a].high[axis] < boxes_[b].low[axis] + boxes_[b].high[axis];
  });
}

std::uint32_t SplitTree::cut_in_half(const Node& node) {
  int axis = 0;
  (node.bounds.high - node.bounds.low).maxCoeff(&axis);
  sort(node, axis);
  return node.begin + (node.end - node.begin) / 2;
}

std::uint32_t SplitTree::cut_by_surface(const Node& node) {
  const std::uint32_t count = node.end - node.begin;
  double best = std::numeric_limits<double>::infinity();
  int best_axis = 0;
  std::uint32_t best_cut = node.begin + count / 2;
  for (int axis = 0; axis < 3; ++axis) {
    sort(node, axis);
    std::vector<double> above(count + 1, 0);  // half surface of what lies from here on
    Aabb bounds;
    for (std::uint32_t i = count; i-- > 0;) {
      bounds.extend(boxes_[order_[node.begin + i]]);
      above[i] = half_area_m2(bounds);
    }
    bounds = {};
    for (std::uint32_t i = 1; i < count; ++i) {
      bounds.extend(boxes_[order_[node.begin + i - 1]]);
      const double cost = i * half_area_m2(bounds) + (count - i) * above[i];
      if (cost >= best) continue;
      best = cost;
      best_axis = axis;
      best_cut = node.begin + i;
    }
  }
  sort(node, best_axis);
  return best_cut;
}

void SplitTree::split(std::uint32_t number, SplitRule rule) {
  const Node node = nodes_[number];
  if (node.end - node.begin <= kLeafBoxes) return;
  const std::uint32_t cut = rule == SplitRule::median ? cut_in_half(node) : cut_by_surface(node);
  const auto children = static_cast<std::uint32_t>(nodes_.size());
  nodes_[number].children = children;
  for (const auto& [begin, end] : {std::pair{node.begin, cut}, {cut, node.end}}) {
    Node child{.bounds = {}, .begin = begin, .end = end};
    for (std::uint32_t i = begin; i < end; ++i) child.bounds.extend(boxes_[order_[i]]);
    nodes_.push_back(child);
  }
  split(children, rule);
  split(children + 1, rule);
}

template <class Leaf>
std::uint64_t SplitTree::walk(const Ray& ray, Leaf leaf) const {
  std::uint64_t visited = 0;
  std::vector<std::uint32_t> waiting{0};
  while (!waiting.empty()) {
    const Node& node = nodes_[waiting.back()];
    waiting.pop_back();
    if (!ray_meets(ray, node.bounds)) continue;
    ++visited;
    if (node.children == 0) leaf(node);
    else waiting.insert(waiting.end(), {node.children, node.children + 1});
  }
  return visited;
}

std::uint64_t SplitTree::visited(const Ray& ray) const {
  return walk(ray, [](const Node&) {});
}

std::vector<std::uint32_t> SplitTree::met(const Ray& ray) const {
  std::vector<std::uint32_t> found;
  walk(ray, [&](const Node& node) {
    for (std::uint32_t i = node.begin; i < node.end; ++i) {
      if (ray_meets(ray, boxes_[order_[i]])) found.push_back(order_[i]);
    }
  });
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace collided::oracle
