#include "client/draw/drawing/halo.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace collided::draw {
namespace {

/// Two segments whose depths at a crossing differ by less than this fraction of them meet in space.
constexpr double kSameDepth = 1e-9;

double depth_at(const LineSegment& s, double fraction, bool is_orthographic) {
  if (is_orthographic) return s.image_a.depth_m + fraction * (s.image_b.depth_m - s.image_a.depth_m);
  return 1 / (1 / s.image_a.depth_m + fraction * (1 / s.image_b.depth_m - 1 / s.image_a.depth_m));
}

/// Whether the images of two segments cross strictly inside both, and at which fractions of them.
bool cross_at(const LineSegment& s, const LineSegment& t, double& of_s, double& of_t) {
  const double sx = s.image_b.x - s.image_a.x, sy = s.image_b.y - s.image_a.y;
  const double tx = t.image_b.x - t.image_a.x, ty = t.image_b.y - t.image_a.y;
  const double area = sx * ty - sy * tx;
  if (area == 0) return false;
  const double dx = t.image_a.x - s.image_a.x, dy = t.image_a.y - s.image_a.y;
  of_s = (dx * ty - dy * tx) / area;
  of_t = (dx * sy - dy * sx) / area;
  return of_s > 0 && of_s < 1 && of_t > 0 && of_t < 1;
}

bool share_end(const LineSegment& s, const LineSegment& t) {
  return s.a == t.a || s.a == t.b || s.b == t.a || s.b == t.b;
}

double distance_px(const LineSegment& s, double x, double y) {
  const double dx = s.image_b.x - s.image_a.x, dy = s.image_b.y - s.image_a.y;
  const double px = x - s.image_a.x, py = y - s.image_a.y;
  const double squared = dx * dx + dy * dy;
  const double t = squared > 0 ? std::clamp((px * dx + py * dy) / squared, 0.0, 1.0) : 0;
  return std::hypot(px - t * dx, py - t * dy);
}

/// Where, between `at` and `end`, the farther segment leaves the halo. It does so only once, since the neighbourhood of
/// a segment is convex.
double end_of_halo(const LineSegment& nearer, const LineSegment& farther, double at, double end, double halo_px) {
  const auto is_inside = [&](double t) {
    const double x = farther.image_a.x + t * (farther.image_b.x - farther.image_a.x);
    const double y = farther.image_a.y + t * (farther.image_b.y - farther.image_a.y);
    return distance_px(nearer, x, y) < halo_px;
  };
  if (is_inside(end)) return end;
  double inside = at;
  double outside = end;
  for (int i = 0; i < 40; ++i) {
    const double middle = (inside + outside) / 2;
    (is_inside(middle) ? inside : outside) = middle;
  }
  return outside;
}

}  // namespace

std::vector<LineCrossing> crossings(std::span<const LineSegment> segments, bool is_orthographic) {
  const auto left = [&](std::uint32_t i) { return std::min(segments[i].image_a.x, segments[i].image_b.x); };
  const auto right = [&](std::uint32_t i) { return std::max(segments[i].image_a.x, segments[i].image_b.x); };
  std::vector<std::uint32_t> order(segments.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t j) { return left(i) < left(j); });
  std::vector<LineCrossing> found;
  std::vector<std::uint32_t> open;
  for (const std::uint32_t i : order) {
    std::erase_if(open, [&](std::uint32_t j) { return right(j) < left(i); });
    for (const std::uint32_t j : open) {
      const LineSegment& s = segments[i];
      const LineSegment& t = segments[j];
      double of_s = 0;
      double of_t = 0;
      if (s.line == t.line || !cross_at(s, t, of_s, of_t) || share_end(s, t)) continue;
      const double s_depth = depth_at(s, of_s, is_orthographic);
      const double t_depth = depth_at(t, of_t, is_orthographic);
      if (std::abs(s_depth - t_depth) <= kSameDepth * (std::abs(s_depth) + std::abs(t_depth))) continue;
      found.push_back(s_depth < t_depth ? LineCrossing{i, j, of_t} : LineCrossing{j, i, of_s});
    }
    open.push_back(i);
  }
  return found;
}

std::vector<Piece> haloed_pieces(std::span<const LineSegment> segments, std::span<const LineCrossing> crossings,
                                 double halo_px) {
  std::vector<std::vector<std::pair<double, double>>> gaps(segments.size());
  for (const LineCrossing& c : crossings) {
    const LineSegment& nearer = segments[c.nearer];
    const LineSegment& farther = segments[c.farther];
    gaps[c.farther].emplace_back(end_of_halo(nearer, farther, c.at, 0, halo_px),
                                 end_of_halo(nearer, farther, c.at, 1, halo_px));
  }
  std::vector<Piece> pieces;
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    std::sort(gaps[i].begin(), gaps[i].end());
    double from = 0;
    for (const auto& [begin, end] : gaps[i]) {
      if (begin > from) pieces.push_back({i, from, begin, true});
      from = std::max(from, end);
    }
    if (from < 1) pieces.push_back({i, from, 1, true});
  }
  return pieces;
}

}  // namespace collided::draw
