#include "server/intake/mesh/seams.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/geometry/tolerance.hpp"
#include "server/intake/mesh/segment_grid.hpp"

namespace collided::engine {
namespace {

/// An edge that only one triangle has.
struct Border {
  HalfEdge half = 0;
  std::uint32_t from = 0;  // points
  std::uint32_t to = 0;
  std::uint32_t opposite = 0;
};

class SeamSearch {
 public:
  SeamSearch(const TriangleMesh& mesh, const EdgeTable& table, const std::vector<std::uint32_t>& point_of,
             const SeamReach& reach)
      : mesh_(mesh), point_of_(point_of), reach_(reach) {
    collect_borders(table);
    if (!borders_.empty()) measure_edges(table);
  }

  Seams run(const Aabb& bounds) {
    if (borders_.empty() || !std::isfinite((bounds.high - bounds.low).squaredNorm())) return {};
    std::vector<MeshSegment> segments;
    segments.reserve(borders_.size());
    for (const Border& border : borders_) segments.push_back({at(border.from), at(border.to)});
    const SegmentGrid grid(segments, bounds, std::max(reach_.crack_m, reach_.on_edge_m));
    std::vector<std::uint32_t> points;
    for (const Border& border : borders_) points.insert(points.end(), {border.from, border.to});
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    points_ = std::move(points);
    nearest_.reserve(points_.size());
    for (const std::uint32_t point : points_) {
      if (test_count_ > reach_.max_tests) break;
      nearest_.push_back(look_around(point, grid));
    }
    const std::uint64_t unseen_count = points_.size() - nearest_.size();
    nearest_.resize(points_.size());
    return {told(), unseen_count};
  }

 private:
  const Vec3& at(std::uint32_t point) const { return mesh_.vertices[point]; }

  void collect_borders(const EdgeTable& table) {
    for (std::size_t i = 0; i < table.size(); ++i) {
      const auto uses = table.uses_of(i);
      if (uses.size() != 1) continue;
      const TriangleCorners& corners = mesh_.triangles[triangle_of(uses[0])];
      const std::uint32_t k = uses[0] % 3;
      borders_.push_back(
          {uses[0], point_of_[corners[k]], point_of_[corners[(k + 1) % 3]], point_of_[corners[(k + 2) % 3]]});
    }
  }

  void measure_edges(const EdgeTable& table) {
    shortest_m_.assign(mesh_.vertices.size(), std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < table.size(); ++i) {
      const auto& edge = table.edges[i];
      const double length_m = (at(edge.low) - at(edge.high)).norm();
      shortest_m_[edge.low] = std::min(shortest_m_[edge.low], length_m);
      shortest_m_[edge.high] = std::min(shortest_m_[edge.high], length_m);
    }
  }

  double allowed_m(std::uint32_t point) const { return std::min(reach_.crack_m, kCrackShare * shortest_m_[point]); }

  /// The nearest other point and the nearest edge of the border, if they are near enough.
  struct NearestSeam {
    Seam to_point{.kind = Seam::Kind::beside_point};
    Seam to_edge{.kind = Seam::Kind::beside_edge};
    bool has_point = false;
    bool has_edge = false;
  };

  NearestSeam look_around(std::uint32_t point, const SegmentGrid& grid) {
    NearestSeam found;
    found.to_point.point = found.to_edge.point = point;
    found.to_point.gap_m = allowed_m(point);
    found.to_edge.gap_m = std::min(std::max(reach_.crack_m, reach_.on_edge_m), kCrackShare * shortest_m_[point]);
    grid.visit_near(at(point), [&](std::uint32_t i) {
      ++test_count_;
      const Border& border = borders_[i];
      if (border.from == point || border.to == point) return;
      weigh_point(border, border.from, found);
      weigh_point(border, border.to, found);
      if (border.opposite != point) weigh_edge(border, found);  // false: a sliver triangle's own corner
    });
    return found;
  }

  void weigh_point(const Border& border, std::uint32_t end, NearestSeam& found) const {
    Seam& best = found.to_point;
    const double gap_m = (at(end) - at(best.point)).norm();
    if (!(gap_m <= std::min(best.gap_m, allowed_m(end)))) return;
    if (found.has_point && gap_m == best.gap_m && end >= best.other_point) return;
    best.gap_m = gap_m;
    best.other_point = end;
    best.edge = border.half;
    found.has_point = true;
  }

  void weigh_edge(const Border& border, NearestSeam& found) const {
    Seam& best = found.to_edge;
    const double gap_m = gap_to_inside(border, best.point);
    if (!(gap_m <= best.gap_m) || (found.has_edge && gap_m == best.gap_m && border.half >= best.edge)) return;
    best.gap_m = gap_m;
    best.edge = border.half;
    best.kind = gap_m <= reach_.on_edge_m ? Seam::Kind::t_vertex : Seam::Kind::beside_edge;
    found.has_edge = true;
  }

  /// The seams found. A near point is preferred to any edge: a point beside the end of an edge is not on the edge.
  std::vector<Seam> told() const {
    std::vector<Seam> seams;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const NearestSeam& own = nearest_[i];
      if (own.has_point) {
        // Two points usually find each other; such a pair is reported once.
        const auto other = std::lower_bound(points_.begin(), points_.end(), own.to_point.other_point) - points_.begin();
        const NearestSeam& its = nearest_[static_cast<std::size_t>(other)];
        const bool is_mutual = its.has_point && its.to_point.other_point == points_[i];
        if (!is_mutual || points_[i] < own.to_point.other_point) seams.push_back(own.to_point);
      } else if (own.has_edge) {
        seams.push_back(own.to_edge);
      }
    }
    return seams;
  }

  /// The point's distance to the edge, if the nearest point of the edge is between its ends and clear of both. Infinite
  /// elsewhere, and if the triangle is so flat that a move by that distance would turn it over.
  double gap_to_inside(const Border& border, std::uint32_t point) const {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    const Vec3 along = at(border.to) - at(border.from);
    const Vec3 to_point = at(point) - at(border.from);
    const double length2 = along.squaredNorm();
    const double foot = to_point.dot(along);
    if (!(foot > 0 && foot < length2)) return kFar;
    const double gap_m = along.cross(to_point).norm() / std::sqrt(length2);
    if (gap_m <= reach_.on_edge_m) return gap_m;
    const double height_m = along.cross(at(border.opposite) - at(border.from)).norm() / std::sqrt(length2);
    return gap_m <= kCrackShare * height_m ? gap_m : kFar;
  }

  const TriangleMesh& mesh_;
  const std::vector<std::uint32_t>& point_of_;
  SeamReach reach_;
  std::vector<Border> borders_;
  std::vector<double> shortest_m_;     // among the edges at each point
  std::vector<std::uint32_t> points_;  // of the border, ascending
  std::vector<NearestSeam> nearest_;   // for each of points_
  std::uint64_t test_count_ = 0;
};

}  // namespace

SeamReach seam_reach(const TriangleMesh& mesh, const Aabb& bounds, double crack_m) {
  if (bounds.empty()) return {};
  const double largest_m = std::max(bounds.low.cwiseAbs().maxCoeff(), bounds.high.cwiseAbs().maxCoeff());
  const bool is_single = std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                                     [](const Vec3& v) { return v.cast<float>().cast<double>() == v; });
  const double rounding = is_single ? 0.5 * std::numeric_limits<float>::epsilon() : kRoundoff;
  return {.on_edge_m = kOnEdge * rounding * largest_m,
          .crack_m = crack_m > 0 ? crack_m : kCrackReach * (bounds.high - bounds.low).norm()};
}

Seams find_seams(const TriangleMesh& mesh, const EdgeTable& table, const std::vector<std::uint32_t>& point_of,
                 const SeamReach& reach, const Aabb& bounds) {
  return SeamSearch(mesh, table, point_of, reach).run(bounds);
}

}  // namespace collided::engine
