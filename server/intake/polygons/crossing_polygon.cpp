#include "server/intake/polygons/crossing_polygon.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "server/intake/limits.hpp"
#include "server/intake/polygons/polygon_plane.hpp"
#include "server/intake/polygons/triangulate.hpp"

namespace collided::engine {
namespace {

struct PolygonCorner {
  PlanePoint at;
  std::uint32_t vertex;
};
using Loop = std::vector<PolygonCorner>;

/// The first two edges that cross, by the corners at which they begin.
std::optional<std::pair<std::size_t, std::size_t>> first_crossing(const Loop& loop) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    for (std::size_t k = i + 2; k < loop.size(); ++k) {
      if (edges_cross(loop[i].at, loop[i + 1].at, loop[k].at, loop[(k + 1) % loop.size()].at)) return std::pair(i, k);
    }
  }
  return std::nullopt;
}

/// Where ab crosses cd, as a fraction of the length from a to b.
double share_along(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  const double from = (d[0] - c[0]) * (a[1] - c[1]) - (d[1] - c[1]) * (a[0] - c[0]);
  const double to = (d[0] - c[0]) * (b[1] - c[1]) - (d[1] - c[1]) * (b[0] - c[0]);
  return std::clamp(from / (from - to), 0.0, 1.0);
}

/// A new vertex half-way between two edges where they cross in projection. Nothing if they are too far apart in space,
/// as in a bent polygon.
std::optional<PolygonCorner> crossing_point(const Loop& loop, std::size_t i, std::size_t k, double largest_gap,
                                            std::vector<Vec3>& vertices) {
  const PolygonCorner& a = loop[i];
  const PolygonCorner& b = loop[i + 1];
  const PolygonCorner& c = loop[k];
  const PolygonCorner& d = loop[(k + 1) % loop.size()];
  const double along_first = share_along(a.at, b.at, c.at, d.at);
  const double along_second = share_along(c.at, d.at, a.at, b.at);
  const Vec3 on_first = vertices[a.vertex] + along_first * (vertices[b.vertex] - vertices[a.vertex]);
  const Vec3 on_second = vertices[c.vertex] + along_second * (vertices[d.vertex] - vertices[c.vertex]);
  if (!((on_first - on_second).norm() <= largest_gap)) return std::nullopt;
  vertices.push_back(on_first / 2 + on_second / 2);
  const PlanePoint at{a.at[0] + along_first * (b.at[0] - a.at[0]), a.at[1] + along_first * (b.at[1] - a.at[1])};
  return PolygonCorner{at, static_cast<std::uint32_t>(vertices.size() - 1)};
}

double size_of(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices) {
  double size = 0;
  for (const std::uint32_t corner : corners) size = std::max(size, (vertices[corner] - vertices[corners[0]]).norm());
  return size;
}

void cut_lobe(const Loop& lobe, const std::vector<Vec3>& vertices, std::vector<TriangleCorners>& triangles) {
  std::vector<std::uint32_t> corners;
  for (const PolygonCorner& corner : lobe) corners.push_back(corner.vertex);
  triangulate(corners, vertices, triangles);
}

}  // namespace

std::vector<TriangleCorners> split_at_crossings(std::span<const std::uint32_t> corners, std::vector<Vec3>& vertices) {
  const std::vector<PlanePoint> points = flattened(corners, vertices);
  Loop whole;
  for (std::size_t i = 0; i < corners.size(); ++i) whole.push_back({points[i], corners[i]});
  std::vector<Loop> waiting{std::move(whole)};
  const std::size_t vertex_count = vertices.size();
  const double largest_gap = kFlatEnough * size_of(corners, vertices);
  std::vector<TriangleCorners> triangles;
  while (!waiting.empty()) {
    const Loop loop = std::move(waiting.back());
    waiting.pop_back();
    const auto crossing = first_crossing(loop);
    if (!crossing) {
      if (vertices.size() == vertex_count) return {};
      cut_lobe(loop, vertices, triangles);
      continue;
    }
    const auto [i, k] = *crossing;
    const std::optional<PolygonCorner> at = crossing_point(loop, i, k, largest_gap, vertices);
    if (!at || vertices.size() - vertex_count > kMaxCrossings) {
      vertices.resize(vertex_count);
      return {};
    }
    const auto begin = loop.begin();
    Loop inner{*at};
    inner.insert(inner.end(), begin + static_cast<std::ptrdiff_t>(i) + 1, begin + static_cast<std::ptrdiff_t>(k) + 1);
    Loop outer(begin, begin + static_cast<std::ptrdiff_t>(i) + 1);
    outer.push_back(*at);
    outer.insert(outer.end(), begin + static_cast<std::ptrdiff_t>(k) + 1, loop.end());
    waiting.push_back(std::move(inner));
    waiting.push_back(std::move(outer));
  }
  return triangles;
}

}  // namespace collided::engine
