#include "client/library/recordings/drawn_hull.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <stdexcept>
#include <utility>

namespace collided::client {
namespace {

using HullCorners = std::array<std::uint32_t, 3>;

struct HullFace {
  HullCorners corners{};
  Vec3 normal = Vec3::Zero();
  double offset_m = 0;
};

/// Four points far from each other, the fourth behind the triangle of the others.
struct FirstTetrahedron {
  std::array<std::uint32_t, 4> corners{};
  double slack_m = 0;  // by which rounding may move a point off a plane
};

template <class Away>
std::pair<std::uint32_t, double> farthest_point(const std::vector<Vec3>& points, const Away& away) {
  std::pair<std::uint32_t, double> best{0, -1};
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const double distance_m = away(points[i]);
    if (distance_m > best.second) best = {i, distance_m};
  }
  return best;
}

std::optional<FirstTetrahedron> first_tetrahedron(const std::vector<Vec3>& points) {
  if (points.size() < 4) return std::nullopt;
  const Vec3& origin = points.front();
  const auto [b, length_m] = farthest_point(points, [&](const Vec3& p) { return (p - origin).norm(); });
  const double slack_m = 1e-10 * (length_m + origin.norm());
  if (!(length_m > slack_m)) return std::nullopt;
  const Vec3 along = (points[b] - origin).normalized();
  const auto [c, width_m] = farthest_point(points, [&](const Vec3& p) { return along.cross(p - origin).norm(); });
  if (!(width_m > slack_m)) return std::nullopt;
  const Vec3 normal = along.cross(points[c] - origin).normalized();
  const auto [d, height_m] = farthest_point(points, [&](const Vec3& p) { return std::abs(normal.dot(p - origin)); });
  if (!(height_m > slack_m)) return std::nullopt;
  if (normal.dot(points[d] - origin) < 0) return FirstTetrahedron{{0, b, c, d}, slack_m};
  return FirstTetrahedron{{0, c, b, d}, slack_m};
}

HullFace face_of(const std::vector<Vec3>& points, std::uint32_t i, std::uint32_t j, std::uint32_t k) {
  const Vec3 normal = (points[j] - points[i]).cross(points[k] - points[i]).normalized();
  return {{i, j, k}, normal, normal.dot(points[i])};
}

}  // namespace

std::vector<HullCorners> drawn_hull(const std::vector<Vec3>& points) {
  if (points.size() > kMostHullPoints) throw std::runtime_error("a hull of too many points");
  const std::optional<FirstTetrahedron> first = first_tetrahedron(points);
  if (!first) return {};
  const auto [a, b, c, d] = first->corners;
  std::vector<HullFace> faces{face_of(points, a, b, c), face_of(points, a, c, d), face_of(points, a, d, b),
                              face_of(points, b, d, c)};
  for (std::uint32_t number = 0; number < points.size(); ++number) {
    const auto is_hidden = [&](const HullFace& face) {
      return !(face.normal.dot(points[number]) - face.offset_m > first->slack_m);
    };
    const auto seen = std::partition(faces.begin(), faces.end(), is_hidden);
    // The boundary of the faces visible from the point: edges of exactly one of these faces.
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (auto face = seen; face != faces.end(); ++face) {
      for (std::size_t side = 0; side < 3; ++side) edges.emplace(face->corners[side], face->corners[(side + 1) % 3]);
    }
    faces.erase(seen, faces.end());
    for (const auto& [i, j] : edges) {
      if (!edges.contains({j, i})) faces.push_back(face_of(points, i, j, number));
    }
  }
  std::vector<HullCorners> triangles;
  for (const HullFace& face : faces) triangles.push_back(face.corners);
  return triangles;
}

}  // namespace collided::client
