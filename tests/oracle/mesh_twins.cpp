#include "tests/oracle/mesh_twins.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "server/exact_phase/edge_kinds.hpp"
#include "server/exact_phase/exactly.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::oracle {
using namespace engine;
namespace {

using Rational3 = std::array<mpq_class, 3>;

Rational3 rational(const Vec3& v) { return {mpq_class(v[0]), mpq_class(v[1]), mpq_class(v[2])}; }
Rational3 minus(const Rational3& a, const Rational3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
mpq_class dot(const Rational3& a, const Rational3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Rational3 cross(const Rational3& a, const Rational3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Rational3 normal(const Triangle& t) {
  const Rational3 a = rational(t.a);
  return cross(minus(rational(t.b), a), minus(rational(t.c), a));
}
bool is_flat(const Triangle& t) {
  const Rational3 n = normal(t);
  return n[0] == 0 && n[1] == 0 && n[2] == 0;
}

bool is_less(const Vec3& a, const Vec3& b) { return std::array{a[0], a[1], a[2]} < std::array{b[0], b[1], b[2]}; }

/// Each vertex's first equal one, by sorting.
std::vector<std::uint32_t> points_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> order(mesh.vertices.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return is_less(mesh.vertices[a], mesh.vertices[b]); });
  std::vector<std::uint32_t> points(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool is_same = i > 0 && mesh.vertices[order[i]] == mesh.vertices[order[i - 1]];
    points[order[i]] = is_same ? points[order[i - 1]] : order[i];
  }
  return points;
}

bool meet(const TriangleMesh& mesh, const std::vector<std::uint32_t>& points, std::uint32_t i, std::uint32_t k) {
  const Triangle a = mesh.triangle(i);
  const Triangle b = mesh.triangle(k);
  if (is_flat(a) || is_flat(b)) return false;
  std::vector<Vec3> common;
  std::vector<Vec3> rest_a;
  std::vector<Vec3> rest_b;
  std::set<std::uint32_t> of_a;
  std::set<std::uint32_t> of_b;
  for (const std::uint32_t corner : mesh.triangles[i]) of_a.insert(points[corner]);
  for (const std::uint32_t corner : mesh.triangles[k]) of_b.insert(points[corner]);
  for (const std::uint32_t point : of_a) (of_b.contains(point) ? common : rest_a).push_back(mesh.vertices[point]);
  for (const std::uint32_t point : of_b) {
    if (!of_a.contains(point)) rest_b.push_back(mesh.vertices[point]);
  }
  const auto touch = [](const Triangle& x, const Triangle& y) { return exactly::overlaps(x, y) == Decision::yes; };
  if (common.empty()) return touch(a, b);
  // The far side of either, as a triangle without area.
  if (common.size() == 1) {
    return touch({rest_a[0], rest_a[1], rest_a[1]}, b) || touch(a, {rest_b[0], rest_b[1], rest_b[1]});
  }
  if (common.size() == 2)
    return touch({rest_a[0], rest_a[0], rest_a[0]}, b) || touch(a, {rest_b[0], rest_b[0], rest_b[0]}) ||
           touch({rest_a[0], common[0], common[0]}, {rest_b[0], common[1], common[1]}) ||
           touch({rest_a[0], common[1], common[1]}, {rest_b[0], common[0], common[0]});
  return false;
}

}  // namespace

EdgeUses edge_uses(const TriangleMesh& mesh, const std::vector<std::uint32_t>& point_of,
                   const std::vector<bool>& left_out) {
  EdgeUses uses;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::uint32_t k = 0; k < 3 && !left_out[i]; ++k) {
      const std::uint32_t from = point_of[mesh.triangles[i][k]];
      const std::uint32_t to = point_of[mesh.triangles[i][(k + 1) % 3]];
      if (from != to) uses[{std::min(from, to), std::max(from, to)}].push_back(3 * i + k);
    }
  }
  return uses;
}

std::uint8_t edge_kind(const TriangleMesh& mesh, const std::vector<std::uint32_t>& point_of,
                       const std::vector<HalfEdge>& uses, double crease_cosine, std::span<const std::uint32_t> material,
                       const std::optional<Vec3>& eye) {
  unsigned kind = uses.size() == 1 ? kBoundaryEdge : uses.size() > 2 ? kManyEdge : 0;
  for (const HalfEdge use : uses) {
    if (!material.empty() && material[triangle_of(use)] != material[triangle_of(uses[0])]) kind |= kMaterialEdge;
  }
  if (uses.size() != 2) return static_cast<std::uint8_t>(kind);
  const auto from = [&](HalfEdge use) { return point_of[mesh.triangles[triangle_of(use)][use % 3]]; };
  const Triangle one = mesh.triangle(triangle_of(uses[0]));
  Triangle other = mesh.triangle(triangle_of(uses[1]));
  if (from(uses[0]) == from(uses[1])) std::swap(other.b, other.c);
  const Rational3 n = normal(one);
  const Rational3 m = normal(other);
  // n.m < c |n| |m|, with the root in 512 bits, where only n.m = c |n| |m| itself needs care: squares settle it.
  const mpq_class along = dot(n, m);
  const mpq_class c(crease_cosine);
  const mpq_class left = along * abs(along);
  const mpq_class right = c * abs(c) * dot(n, n) * dot(m, m);
  if (left < right) kind |= kCreaseEdge;
  if (eye) {
    const auto faces = [&](const Rational3& along_normal, const Triangle& t) {
      return dot(along_normal, minus(rational(*eye), rational(t.a))) > 0;
    };
    if (faces(n, one) != faces(m, other)) kind |= kSilhouetteEdge;
  }
  return static_cast<std::uint8_t>(kind);
}

std::vector<Seam> seams(const TriangleMesh& mesh, const SeamReach& reach) {
  const std::vector<std::uint32_t> points = points_of(mesh);
  std::vector<bool> flat(mesh.triangles.size());
  for (std::uint32_t i = 0; i < flat.size(); ++i) flat[i] = is_flat(mesh.triangle(i));
  std::map<std::uint32_t, double> shortest;
  std::map<HalfEdge, std::array<std::uint32_t, 3>> borders;  // from, to, opposite
  std::set<std::uint32_t> border_points;
  for (const auto& [ends, uses] : edge_uses(mesh, points, flat)) {
    const double length = (mesh.vertices[ends.first] - mesh.vertices[ends.second]).norm();
    for (const std::uint32_t end : {ends.first, ends.second}) {
      const auto [entry, is_new] = shortest.try_emplace(end, length);
      entry->second = std::min(entry->second, length);
    }
    if (uses.size() != 1) continue;
    const TriangleCorners& corners = mesh.triangles[triangle_of(uses[0])];
    const std::uint32_t k = uses[0] % 3;
    borders[uses[0]] = {points[corners[k]], points[corners[(k + 1) % 3]], points[corners[(k + 2) % 3]]};
    border_points.insert({ends.first, ends.second});
  }
  std::map<std::uint32_t, Seam> nearest;
  for (const std::uint32_t point : border_points) {
    const Vec3& p = mesh.vertices[point];
    const double share = kCrackShare * shortest[point];
    std::optional<Seam> best_point;
    std::optional<Seam> best_edge;
    for (const auto& [half, border] : borders) {
      const auto [from, to, opposite] = border;
      if (from == point || to == point) continue;
      for (const std::uint32_t end : {from, to}) {
        const double gap = (mesh.vertices[end] - p).norm();
        if (gap > std::min({reach.crack_m, share, kCrackShare * shortest[end]})) continue;
        const bool nearer =
            !best_point || gap < best_point->gap_m || (gap == best_point->gap_m && end < best_point->other_point);
        if (nearer) best_point = Seam{Seam::Kind::beside_point, point, end, half, gap};
      }
      if (opposite == point) continue;
      const Vec3 along = mesh.vertices[to] - mesh.vertices[from];
      const Vec3 displacement = p - mesh.vertices[from];
      const double foot = displacement.dot(along);
      if (!(foot > 0 && foot < along.squaredNorm())) continue;
      const double gap = along.cross(displacement).norm() / std::sqrt(along.squaredNorm());
      const double height =
          along.cross(mesh.vertices[opposite] - mesh.vertices[from]).norm() / std::sqrt(along.squaredNorm());
      const bool on = gap <= reach.on_edge_m;
      if (gap > std::min(std::max(reach.crack_m, reach.on_edge_m), share) || (!on && gap > kCrackShare * height))
        continue;
      if (!best_edge || gap < best_edge->gap_m) {
        best_edge = Seam{on ? Seam::Kind::t_vertex : Seam::Kind::beside_edge, point, 0, half, gap};
      }
    }
    if (best_point) nearest[point] = *best_point;
    else if (best_edge) nearest[point] = *best_edge;
  }
  std::vector<Seam> told;
  for (const auto& [point, seam] : nearest) {
    const auto other = nearest.find(seam.other_point);
    const bool is_pair = seam.kind == Seam::Kind::beside_point && other != nearest.end() &&
                         other->second.kind == Seam::Kind::beside_point && other->second.other_point == point;
    if (!is_pair || point < seam.other_point) told.push_back(seam);
  }
  return told;
}

std::vector<TrianglePair> self_intersections(const TriangleMesh& mesh) {
  const std::vector<std::uint32_t> points = points_of(mesh);
  std::vector<TrianglePair> pairs;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::uint32_t k = i + 1; k < mesh.triangles.size(); ++k) {
      if (meet(mesh, points, i, k)) pairs.push_back({i, k});
    }
  }
  return pairs;
}

}  // namespace collided::oracle
