#include "tests/oracle/plain_bvh.hpp"

#include <algorithm>
#include <cmath>

namespace collided::oracle {
using namespace engine;

namespace {

// What only touches the plane is referred to from one side: a ray that meets it there looks at both.
bool is_above(const Aabb& box, int axis, double plane) { return box.high[axis] > plane; }
bool is_below(const Aabb& box, int axis, double plane) { return box.low[axis] < plane || !is_above(box, axis, plane); }

}  // namespace

struct PlainBvh::Walk {
  const Ray& ray;
  PlainCost& cost;
  FirstHit first{};
};

PlainBvh::PlainBvh(const TriangleMesh& mesh) : mesh_(mesh) {
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle triangle = mesh.triangle(i);
    boxes_.push_back(
        {triangle.a.cwiseMin(triangle.b).cwiseMin(triangle.c), triangle.a.cwiseMax(triangle.b).cwiseMax(triangle.c)});
    all.push_back(i);
  }
  build(std::move(all), 0);
  boxes_ = {};
}

std::uint32_t PlainBvh::leaf(const std::vector<std::uint32_t>& triangles) {
  largest_leaf_ = std::max(largest_leaf_, triangles.size());
  nodes_.push_back(
      {-1, 0, static_cast<std::uint32_t>(references_.size()), static_cast<std::uint32_t>(triangles.size())});
  references_.insert(references_.end(), triangles.begin(), triangles.end());
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

std::uint32_t PlainBvh::build(std::vector<std::uint32_t> triangles, int depth) {
  depth_ = std::max(depth_, depth);
  if (triangles.size() <= kLeafTriangles || depth == kMaxDepth) return leaf(triangles);
  // Of each axis the plane with as many box ends below as above; of the three the one with the smallest larger side.
  std::size_t best = triangles.size();
  Node split;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> ends;
    for (const std::uint32_t t : triangles) ends.insert(ends.end(), {boxes_[t].low[axis], boxes_[t].high[axis]});
    std::nth_element(ends.begin(), ends.begin() + static_cast<std::ptrdiff_t>(triangles.size()), ends.end());
    const double plane = ends[triangles.size()];
    std::size_t below = 0;
    std::size_t above = 0;
    for (const std::uint32_t t : triangles) {
      below += is_below(boxes_[t], axis, plane) ? 1 : 0;
      above += is_above(boxes_[t], axis, plane) ? 1 : 0;
    }
    if (std::max(below, above) >= best) continue;
    best = std::max(below, above);
    split.axis = axis;
    split.plane = plane;
  }
  if (split.axis < 0) return leaf(triangles);
  std::vector<std::uint32_t> below;
  std::vector<std::uint32_t> above;
  for (const std::uint32_t t : triangles) {
    if (is_below(boxes_[t], split.axis, split.plane)) below.push_back(t);
    if (is_above(boxes_[t], split.axis, split.plane)) above.push_back(t);
  }
  triangles = {};
  const auto number = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back(split);
  const std::uint32_t first = build(std::move(below), depth + 1);
  const std::uint32_t second = build(std::move(above), depth + 1);
  nodes_[number].first = first;
  nodes_[number].second = second;
  return number;
}

FirstHit PlainBvh::first_hit(const Ray& ray, PlainCost& cost) const {
  Walk all{ray, cost};
  walk(all, 0, 0, std::numeric_limits<double>::infinity());
  return all.first;
}

/// The part of the ray from one parameter to another, nearer side first: a hit there ends the walk before the farther.
void PlainBvh::walk(Walk& w, std::uint32_t number, double from, double to) const {
  // What a parameter is off by, generously.
  constexpr double kWide = 1e-12;
  if (!(from <= to) || w.first.s < from * (1 - kWide)) return;
  ++w.cost.nodes;
  const Node& node = nodes_[number];
  if (node.axis < 0) {
    for (std::uint32_t i = 0; i < node.second; ++i) w.first.take(mesh_, references_[node.first + i], w.ray);
    w.cost.tests += node.second;
    return;
  }
  const double start = w.ray.origin[node.axis];
  const double along = w.ray.direction[node.axis];
  if (along == 0) {
    if (start <= node.plane) walk(w, node.first, from, to);
    if (start >= node.plane) walk(w, node.second, from, to);
    return;
  }
  const double at = (node.plane - start) / along;
  const double slack = kWide * std::abs(at);
  const bool upward = along > 0;
  walk(w, upward ? node.first : node.second, from, std::min(to, at + slack));
  walk(w, upward ? node.second : node.first, std::max(from, at - slack), to);
}

}  // namespace collided::oracle
