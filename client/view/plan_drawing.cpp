#include "client/view/plan_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "client/draw/svg.hpp"

namespace collided::view {
namespace {

constexpr std::size_t kMostTriangles = 20'000;
constexpr double kWidth_px = 1000;
constexpr double kHeight_px = 700;
constexpr double kMargin_px = 30;

struct Line {
  std::vector<Vec3> points;
  bool moves = false;
};

/// What an object looks like, as lines in the world.
class Outlines {
 public:
  Outlines(const ShownObject& object, std::size_t stride, std::vector<Line>& lines) : object_(object), stride_(stride), lines_(lines) {}

  void operator()(const SphereShape& s) { circle(s.center, s.radius_m); }
  void operator()(const BoxShape& s) {
    for (int axis = 0; axis < 3; ++axis) {
      for (int corner = 0; corner < 4; ++corner) {
        Vec3 from = s.half_m;
        from[(axis + 1) % 3] *= corner % 2 == 0 ? 1 : -1;
        from[(axis + 2) % 3] *= corner / 2 == 0 ? 1 : -1;
        Vec3 to = from;
        to[axis] = -to[axis];
        line({s.center + s.rotation * from, s.center + s.rotation * to});
      }
    }
  }
  void operator()(const EllipsoidShape& s) { circle(s.center, s.half_m.maxCoeff()); }
  void operator()(const CapsuleShape& s) { bar(s.a, s.b, s.radius_m, s.radius_m); }
  void operator()(const CylinderShape& s) { bar(s.a, s.b, s.radius_m, s.radius_m); }
  void operator()(const ConeShape& s) { bar(s.apex, s.base, 0, s.radius_m); }
  template <class Other>
  void operator()(const Other&) {}

  void run(const SurfaceRun& run) {
    for (std::size_t i = 0; i < run.triangle_count; i += stride_) {
      const auto& corners = run.surface->triangles[run.first_triangle + i];
      std::vector<Vec3> loop;
      for (const std::size_t which : {0U, 1U, 2U, 0U}) loop.push_back(run.surface->vertices[corners[which]]);
      line(std::move(loop));
    }
  }

 private:
  /// Round from above, whichever way up is: of three circles two are seen as lines.
  void circle(const Vec3& center, double radius_m) {
    constexpr int kCorners = 24;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<Vec3> loop;
      for (int i = 0; i <= kCorners; ++i) {
        const double angle = 2 * std::numbers::pi * i / kCorners;
        Vec3 point = Vec3::Zero();
        point[(axis + 1) % 3] = radius_m * std::cos(angle);
        point[(axis + 2) % 3] = radius_m * std::sin(angle);
        loop.push_back(center + point);
      }
      line(std::move(loop));
    }
  }
  void bar(const Vec3& a, const Vec3& b, double a_radius_m, double b_radius_m) {
    line({a, b});
    circle(a, a_radius_m);
    circle(b, b_radius_m);
  }
  void line(std::vector<Vec3> points) {
    for (Vec3& point : points) point = object_.pose.position + object_.pose.rotation * point;
    lines_.push_back({std::move(points), object_.moving});
  }

  const ShownObject& object_;
  const std::size_t stride_;
  std::vector<Line>& lines_;
};

std::vector<Line> lines_of(const ShownObjects& shown) {
  std::size_t triangles = 0;
  for (const ShownObject& object : shown.objects) {
    for (const SurfaceRun& run : object.runs) triangles += run.triangle_count;
  }
  std::vector<Line> lines;
  for (const ShownObject& object : shown.objects) {
    Outlines outlines(object, 1 + triangles / kMostTriangles, lines);
    for (const ShapePart& part : object.parts) std::visit(outlines, part);
    for (const SurfaceRun& run : object.runs) {
      if (run.surface) outlines.run(run);
    }
  }
  return lines;
}

}  // namespace

std::string plan_svg(const ShownObjects& shown, bool y_is_up) {
  const std::vector<Line> lines = lines_of(shown);
  const auto flat = [&](const Vec3& p) { return y_is_up ? std::pair(p.x(), p.z()) : std::pair(p.x(), -p.y()); };
  std::pair<double, double> low{INFINITY, INFINITY};
  std::pair<double, double> high{-INFINITY, -INFINITY};
  for (const Line& line : lines) {
    for (const Vec3& point : line.points) {
      if (!point.allFinite()) continue;
      const auto [x, y] = flat(point);
      low = {std::min(low.first, x), std::min(low.second, y)};
      high = {std::max(high.first, x), std::max(high.second, y)};
    }
  }
  draw::Canvas canvas(kWidth_px, kHeight_px, "The world from above");
  const double width = high.first - low.first;
  const double height = high.second - low.second;
  const double scale = std::min((kWidth_px - 2 * kMargin_px) / std::max(width, 1e-9), (kHeight_px - 2 * kMargin_px) / std::max(height, 1e-9));
  for (const Line& line : lines) {
    std::vector<std::pair<double, double>> points;
    for (const Vec3& point : line.points) {
      if (!point.allFinite()) continue;
      const auto [x, y] = flat(point);
      points.emplace_back(kWidth_px / 2 + (x - low.first - width / 2) * scale, kHeight_px / 2 + (y - low.second - height / 2) * scale);
    }
    canvas.polyline(points, line.moves ? draw::kAccent : draw::kInk, line.moves ? 1.2 : 0.5);
  }
  return std::move(canvas).finish();
}

}  // namespace collided::view
