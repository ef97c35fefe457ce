#include "tests/oracle/polygon_bsp.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace collided::oracle {
using namespace engine;
namespace {

/// Of heights over a plane, relative to its normal and the scene; roundings are a thousand times smaller.
constexpr double kSlack = 1e-12;
constexpr int kDraws = 6;

}  // namespace

struct PolygonBsp::Walk {
  const Ray& ray;
  PlainCost& cost;
  FirstHit first{};
};

PolygonBsp::PolygonBsp(const TriangleMesh& mesh, std::mt19937_64& random) : mesh_(mesh) {
  for (const Vec3& vertex : mesh.vertices) reach_ = std::max(reach_, vertex.cwiseAbs().maxCoeff());
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  waiting_ = all.size();
  if (!all.empty()) build(std::move(all), 0, random);
}

/// Of length 1; 0 for a triangle without area.
PolygonBsp::Plane PolygonBsp::plane_of(std::uint32_t triangle) const {
  const Triangle t = mesh_.triangle(triangle);
  const Vec3 normal = (t.b - t.a).cross(t.c - t.a);
  const double length = normal.norm();
  if (!(length > 1e-30)) return {};
  return {normal / length, normal.dot(t.a) / length, kSlack * reach_};
}

PolygonBsp::Sides PolygonBsp::sides_of(const Plane& plane, const std::vector<std::uint32_t>& triangles) const {
  Sides sides;
  for (const std::uint32_t number : triangles) {
    const Triangle t = mesh_.triangle(number);
    const Vec3 heights(plane.height(t.a), plane.height(t.b), plane.height(t.c));
    const bool in_front = heights.maxCoeff() > plane.slack;
    const bool behind = heights.minCoeff() < -plane.slack;
    if (in_front) sides.front.push_back(number);
    if (behind) sides.back.push_back(number);
    if (!in_front && !behind) sides.on.push_back(number);
  }
  return sides;
}

/// Normal 0 where no drawn triangle's plane parts anything.
PolygonBsp::Plane PolygonBsp::choose(const std::vector<std::uint32_t>& triangles, std::mt19937_64& random) const {
  Plane best;
  std::size_t best_cost = std::numeric_limits<std::size_t>::max();
  for (int draw = 0; draw < kDraws; ++draw) {
    const Plane plane = plane_of(triangles[random() % triangles.size()]);
    if (plane.normal.isZero(0)) continue;
    // A few hundred tell enough of how the plane divides.
    std::vector<std::uint32_t> sample;
    const std::size_t step = 1 + triangles.size() / 256;
    for (std::size_t i = 0; i < triangles.size(); i += step) sample.push_back(triangles[i]);
    const Sides sides = sides_of(plane, sample);
    const std::size_t cost = sides.front.size() + sides.back.size() + std::max(sides.front.size(), sides.back.size());
    if (cost < best_cost) {
      best_cost = cost;
      best = plane;
    }
  }
  return best;
}

std::uint32_t PolygonBsp::add(const Plane& plane, const std::vector<std::uint32_t>& triangles) {
  nodes_.push_back(
      {plane, static_cast<std::uint32_t>(references_.size()), static_cast<std::uint32_t>(triangles.size())});
  references_.insert(references_.end(), triangles.begin(), triangles.end());
  return static_cast<std::uint32_t>(nodes_.size() - 1);
}

std::uint32_t PolygonBsp::build(std::vector<std::uint32_t> triangles, int depth, std::mt19937_64& random) {
  waiting_ -= triangles.size();
  depth_ = std::max(depth_, depth);
  const bool too_many = references_.size() + waiting_ > kMostReferences * mesh_.triangles.size();
  const Plane plane = triangles.size() <= 1 || depth == kMaxDepth || too_many ? Plane{} : choose(triangles, random);
  if (plane.normal.isZero(0)) return add({}, triangles);
  Sides sides = sides_of(plane, triangles);
  triangles = {};
  const std::uint32_t number = add(plane, sides.on);
  waiting_ += sides.front.size() + sides.back.size();
  if (!sides.front.empty()) {
    const std::uint32_t front = build(std::move(sides.front), depth + 1, random);
    nodes_[number].front = front;
  }
  if (!sides.back.empty()) {
    const std::uint32_t back = build(std::move(sides.back), depth + 1, random);
    nodes_[number].back = back;
  }
  return number;
}

std::vector<std::uint32_t> PolygonBsp::front_to_back(const Vec3& eye) const {
  std::vector<std::uint32_t> order;
  // A node stands here twice: to be opened, then, behind its nearer side, to be told.
  std::vector<std::pair<std::uint32_t, bool>> waiting;
  if (!nodes_.empty()) waiting.emplace_back(0, false);
  while (!waiting.empty()) {
    const auto [number, is_open] = waiting.back();
    waiting.pop_back();
    const Node& node = nodes_[number];
    if (is_open || node.plane.normal.isZero(0)) {
      order.push_back(number);
      continue;
    }
    const bool in_front = node.plane.height(eye) >= 0;
    const std::uint32_t nearer = in_front ? node.front : node.back, farther = in_front ? node.back : node.front;
    if (farther != kNone) waiting.emplace_back(farther, false);
    waiting.emplace_back(number, true);
    if (nearer != kNone) waiting.emplace_back(nearer, false);
  }
  return order;
}

std::uint32_t PolygonBsp::node_of(std::uint32_t triangle, const Vec3& point) const {
  for (std::uint32_t number = nodes_.empty() ? kNone : 0; number != kNone;) {
    const Node& node = nodes_[number];
    const auto own = references_.begin() + node.first_reference;
    if (std::find(own, own + node.reference_count, triangle) != own + node.reference_count) return number;
    const double height = node.plane.height(point);
    if (node.plane.normal.isZero(0) || std::abs(height) <= 4 * node.plane.slack) return kNone;
    number = height > 0 ? node.front : node.back;
  }
  return kNone;
}

int PolygonBsp::side_of(std::uint32_t triangle, const Vec3& point) const {
  const Plane plane = plane_of(triangle);
  const double height = plane.height(point);
  return height > plane.slack ? 1 : height < -plane.slack ? -1 : 0;
}

FirstHit PolygonBsp::first_hit(const Ray& ray, PlainCost& cost) const {
  Walk all{ray, cost};
  if (!nodes_.empty()) walk(all, 0, 0, std::numeric_limits<double>::infinity());
  return all.first;
}

void PolygonBsp::walk(Walk& w, std::uint32_t number, double from, double to) const {
  if (number == kNone || !(from <= to) || w.first.s < from * (1 - kSlack)) return;
  ++w.cost.nodes;
  const Node& node = nodes_[number];
  const auto test_own = [&] {
    for (std::uint32_t i = 0; i < node.reference_count; ++i) {
      w.first.take(mesh_, references_[node.first_reference + i], w.ray);
    }
    w.cost.tests += node.reference_count;
  };
  if (node.plane.normal.isZero(0)) return test_own();
  const double height = node.plane.height(w.ray.origin);
  const double climb = node.plane.normal.dot(w.ray.direction);
  // Within this height the ray may be on either side, for all that rounding tells.
  const double slack = 4 * node.plane.slack + kSlack * w.ray.origin.cwiseAbs().maxCoeff();
  const double climb_slack = 8 * std::numeric_limits<double>::epsilon() * w.ray.direction.norm();
  if (std::abs(climb) <= climb_slack) {
    // Along the plane: no parameter parts its sides.
    walk(w, height >= 0 ? node.front : node.back, from, to);
    test_own();
    walk(w, height >= 0 ? node.back : node.front, from, to);
    return;
  }
  const double at = -height / climb;
  const double wide = (slack + std::abs(at) * climb_slack) / std::abs(climb);
  const bool falling = climb < 0;
  walk(w, falling ? node.front : node.back, from, std::min(to, at + wide));
  if (at + wide >= from && at - wide <= to) test_own();
  walk(w, falling ? node.back : node.front, std::max(from, at - wide), to);
}

}  // namespace collided::oracle
