#include "tests/drawing/methods/edge_image.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

namespace collided::drawing_test {
namespace {

void for_seen_pixels(const draw::Drawing& drawing, bool silhouettes_only, double from_ends_px,
                     const std::function<void(double, double, const draw::LineSegment&)>& use) {
  for (const draw::Piece& piece : drawing.pieces) {
    const draw::LineSegment& s = drawing.segments[piece.segment];
    if (!piece.is_seen || (silhouettes_only && s.kind != draw::LineKind::silhouette)) continue;
    const double length_px = (piece.to - piece.from) * s.length_px();
    for (double along = from_ends_px; along <= length_px - from_ends_px; along += 1) {
      const double t = piece.from + (length_px > 0 ? along / length_px : 0) * (piece.to - piece.from);
      use(s.image_a.x + t * (s.image_b.x - s.image_a.x), s.image_a.y + t * (s.image_b.y - s.image_a.y), s);
    }
  }
}

bool any_black(const Mask& mask, double x, double y, double reach_px) {
  for (double dy = -reach_px; dy <= reach_px; dy += 0.5) {
    for (double dx = -reach_px; dx <= reach_px; dx += 0.5) {
      if (dx * dx + dy * dy <= reach_px * reach_px && mask.at(x + dx, y + dy)) return true;
    }
  }
  return false;
}

}  // namespace

Mask edge_image(const Buffers& buffers, const draw::Camera& camera, double crease_cosine, double bend_px) {
  Mask mask(buffers.width, buffers.height);
  const auto is_edge = [&](int x, int y, int dx, int dy) {
    if (!buffers.has(x - dx, y - dy) || !buffers.has(x + dx, y + dy)) return false;
    const std::size_t at = buffers.index(x, y), before = buffers.index(x - dx, y - dy),
                      after = buffers.index(x + dx, y + dy);
    if (std::isinf(buffers.depth_m[at])) return false;  // the side that is something has the line
    if (std::isinf(buffers.depth_m[before]) || std::isinf(buffers.depth_m[after])) return true;
    // A plane is linear in 1 / depth.
    const double bend = 1 / buffers.depth_m[before] + 1 / buffers.depth_m[after] - 2 / buffers.depth_m[at];
    const double pixel_m = camera.pixel_m(camera.eye() + buffers.depth_m[at] * camera.forward());
    if (std::abs(bend) * buffers.depth_m[at] * buffers.depth_m[at] > bend_px * pixel_m) return true;
    return buffers.normals[at].dot(buffers.normals[before]) < crease_cosine ||
           buffers.normals[at].dot(buffers.normals[after]) < crease_cosine;
  };
  for (int y = 0; y < buffers.height; ++y) {
    for (int x = 0; x < buffers.width; ++x) {
      if (is_edge(x, y, 1, 0) || is_edge(x, y, 0, 1)) mask.black[buffers.index(x, y)] = 1;
    }
  }
  return mask;
}

Agreement agreement(const Mask& mask, const draw::Drawing& drawing) {
  Agreement result;
  Mask lines(mask.width, mask.height);
  for_seen_pixels(drawing, false, 0.5, [&](double x, double y, const draw::LineSegment&) {
    if (!(x >= 0 && y >= 0 && x < mask.width && y < mask.height)) return;
    lines.black[static_cast<std::size_t>(y) * mask.width + static_cast<std::size_t>(x)] = 1;
    ++result.line_pixels;
    result.found += any_black(mask, x, y, 1) ? 1 : 0;
  });
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      if (!mask.at(x, y)) continue;
      ++result.black_pixels;
      result.justified += any_black(lines, x + 0.5, y + 0.5, 2) ? 1 : 0;
    }
  }
  return result;
}

double Widths::mean_px() const { return std::accumulate(px.begin(), px.end(), 0.0) / static_cast<double>(px.size()); }

double Widths::spread() const {
  const double mean = mean_px();
  double sum = 0;
  for (const double width : px) sum += (width - mean) * (width - mean);
  return std::sqrt(sum / static_cast<double>(px.size())) / mean;
}

Widths widths_across_silhouette(const Mask& mask, const draw::Drawing& drawing, double from_ends_px, double reach_px) {
  constexpr double kStep_px = 0.1;
  Widths widths;
  const draw::LineSegment* line = nullptr;
  std::size_t on_line = 0;
  for_seen_pixels(drawing, true, from_ends_px, [&](double x, double y, const draw::LineSegment& s) {
    const double length = s.length_px();
    const double nx = (s.image_b.y - s.image_a.y) / length;
    const double ny = (s.image_a.x - s.image_b.x) / length;
    double width = 0;
    for (double t = -reach_px; t <= reach_px; t += kStep_px) width += mask.at(x + t * nx, y + t * ny) ? kStep_px : 0;
    widths.px.push_back(width);
    if (&s != line) {
      widths.line_means_px.push_back(0);
      on_line = 0;
    }
    line = &s;
    ++on_line;
    double& mean = widths.line_means_px.back();
    mean += (width - mean) / static_cast<double>(on_line);
  });
  std::sort(widths.px.begin(), widths.px.end());
  return widths;
}

double widest_gap_px(const Mask& mask, const Buffers& buffers, const draw::Drawing& drawing, double radius_px) {
  constexpr int kSteps = 720;
  double widest = 0;
  for (const draw::LineSegment& s : drawing.segments) {
    if (s.kind != draw::LineKind::silhouette) continue;
    for (const draw::ImagePoint& end : {s.image_a, s.image_b}) {
      int run = 0;
      // Twice around: a gap may lie across the beginning.
      for (int i = 0; i < 2 * kSteps; ++i) {
        const double angle = 2 * std::numbers::pi * i / kSteps;
        const double x = end.x + radius_px * std::cos(angle), y = end.y + radius_px * std::sin(angle);
        const bool is_outside = buffers.has(static_cast<int>(x), static_cast<int>(y)) &&
                                std::isinf(buffers.depth_m[buffers.index(static_cast<int>(x), static_cast<int>(y))]);
        run = is_outside && !mask.at(x, y) ? run + 1 : 0;
        widest = std::max(widest, run * 2 * std::numbers::pi * radius_px / kSteps);
      }
    }
  }
  return widest;
}

}  // namespace collided::drawing_test
