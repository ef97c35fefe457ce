#include "server/intake/polygons/triangulate.hpp"

#include <array>
#include <cmath>

#include "server/intake/limits.hpp"
#include "server/intake/polygons/planar.hpp"
#include "server/intake/polygons/polygon_plane.hpp"
#include "server/intake/polygons/sweep_triangulation.hpp"

namespace collided::engine {
namespace {

/// Whether no corner turns right and the edges go round once, that is, change from falling to rising once.
bool is_convex(const std::vector<PlanePoint>& points) {
  const std::size_t count = points.size();
  int swings = 0;
  int last_rise = 0;
  for (std::size_t i = 0; i < 2 * count; ++i) {
    const PlanePoint& here = points[i % count];
    const PlanePoint& next = points[(i + 1) % count];
    if (i < count && turn(here, next, points[(i + 2) % count]) < 0) { return false; }
    const double rise = next[1] != here[1] ? next[1] - here[1] : 0;
    if (rise != 0) {
      const int sign = rise > 0 ? 1 : -1;
      swings += i >= count && sign != last_rise ? 1 : 0;
      last_rise = sign;
    }
  }
  return swings <= 2;
}

/// Cuts a polygon into triangles by clipping ears; holds the remaining polygon as a ring of corners.
class EarClipper {
 public:
  EarClipper(std::span<const std::uint32_t> corners, std::vector<PlanePoint> points)
      : corners_(corners), points_(std::move(points)), previous_(corners.size()), next_(corners.size()) {
    const std::size_t count = corners.size();
    for (std::size_t i = 0; i < count; ++i) {
      previous_[i] = (i + count - 1) % count;
      next_[i] = (i + 1) % count;
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (turn_at(i) <= 0) { reflex_.push_back(i); }
    }
  }

  /// Appends the triangles. True if each one was an ear; false if some had to be guessed.
  bool clip(std::vector<TriangleCorners>& triangles) {
    bool all_ears = true;
    std::size_t at = 0;
    std::size_t tried = 0;
    for (std::size_t left = corners_.size(); left > 3;) {
      const bool ear = is_ear(at);
      if (!ear && ++tried <= left) {
        at = next_[at];
        continue;
      }
      all_ears = all_ears && ear;
      triangles.push_back({corners_[previous_[at]], corners_[at], corners_[next_[at]]});
      next_[previous_[at]] = next_[at];
      previous_[next_[at]] = previous_[at];
      std::erase(reflex_, at);
      drop_if_convex(previous_[at]);
      drop_if_convex(next_[at]);
      at = next_[next_[at]];  // skips the neighbour: going around evenly makes fewer slivers
      tried = 0;
      --left;
    }
    triangles.push_back({corners_[previous_[at]], corners_[at], corners_[next_[at]]});
    return all_ears && turn_at(at) >= 0;
  }

 private:
  int turn_at(std::size_t i) const { return turn(points_[previous_[i]], points_[i], points_[next_[i]]); }

  void drop_if_convex(std::size_t i) {
    if (turn_at(i) > 0) { std::erase(reflex_, i); }
  }

  /// Whether the corner turns left and its triangle contains no other corner. A corner between its neighbours on a line
  /// counts too; it is clipped as a triangle without area.
  bool is_ear(std::size_t i) const {
    const PlanePoint& a = points_[previous_[i]];
    const PlanePoint& b = points_[i];
    const PlanePoint& c = points_[next_[i]];
    const int side = turn(a, b, c);
    if (side == 0) { return lies_between(a, b, c); }
    if (side < 0) { return false; }
    for (const std::size_t other : reflex_) {
      const PlanePoint& p = points_[other];
      if (other == previous_[i] || other == next_[i] || p == a || p == c) { continue; }
      if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) { return false; }
    }
    return true;
  }

  static bool lies_between(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
    const auto within = [](double low, double x, double high) {
      return (low <= x && x <= high) || (high <= x && x <= low);
    };
    return within(a[0], b[0], c[0]) && within(a[1], b[1], c[1]);
  }

  std::span<const std::uint32_t> corners_;
  std::vector<PlanePoint> points_;
  std::vector<std::size_t> previous_;
  std::vector<std::size_t> next_;
  std::vector<std::size_t> reflex_;
};

/// Polygons of more corners are cut by the sweep; up to here ears are cheaper.
constexpr std::size_t kEarCorners = 100;

bool cut_by_sweep(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> ring_ends,
                  std::span<const PlanePoint> points, std::vector<TriangleCorners>& triangles) {
  const std::size_t first_new = triangles.size();
  if (triangulate_by_sweep(points, ring_ends, triangles)) return false;
  for (std::size_t i = first_new; i < triangles.size(); ++i) {
    for (std::uint32_t& corner : triangles[i]) corner = corners[corner];
  }
  return true;
}

bool crosses_itself(const std::vector<PlanePoint>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t k = i + 2; k < points.size(); ++k) {
      if (edges_cross(points[i], points[i + 1], points[k], points[(k + 1) % points.size()])) return true;
    }
  }
  return false;
}

}  // namespace

PolygonKind triangulate(std::span<const std::uint32_t> corners, const std::vector<Vec3>& vertices,
                        std::vector<TriangleCorners>& triangles) {
  if (corners.size() == 3) {
    triangles.push_back({corners[0], corners[1], corners[2]});
    return PolygonKind::convex;
  }
  std::vector<PlanePoint> points = flattened(corners, vertices);
  if (is_convex(points)) {
    for (std::size_t i = 2; i < corners.size(); ++i) { triangles.push_back({corners[0], corners[i - 1], corners[i]}); }
    return PolygonKind::convex;
  }
  const bool is_long = corners.size() > kEarCorners;
  const std::array<std::uint32_t, 1> one_ring{static_cast<std::uint32_t>(corners.size())};
  if (is_long && cut_by_sweep(corners, one_ring, points, triangles)) return PolygonKind::concave;
  if (corners.size() > kMaxConcaveCorners) return PolygonKind::too_long;
  const bool crosses = crosses_itself(points);
  const bool all_ears = EarClipper(corners, std::move(points)).clip(triangles);
  return all_ears && !crosses ? PolygonKind::concave : PolygonKind::crossing;
}

PolygonKind triangulate_with_holes(std::span<const std::uint32_t> corners, std::span<const std::uint32_t> ring_ends,
                                   const std::vector<Vec3>& vertices, std::vector<TriangleCorners>& triangles) {
  if (ring_ends.size() == 1) return triangulate(corners, vertices, triangles);
  const std::vector<PlanePoint> points = flattened(corners, ring_ends, vertices);
  return cut_by_sweep(corners, ring_ends, points, triangles) ? PolygonKind::concave : PolygonKind::crossing;
}

}  // namespace collided::engine
