#include "server/world/fences/fence_outline.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "server/world/objects/contact_search.hpp"

namespace collided::engine {
namespace {

constexpr int kCirclePieces = 32;
constexpr double kPlaneReach_m = 10;
constexpr std::size_t kMostEdges = 2'000;  // edges of a mesh; with more its bounding box is shown
constexpr double kFlat = 0.9998;           // cosine of 1 degree: faces this flat to each other have no edge

class Outline {
 public:
  explicit Outline(double beyond_m) : beyond_m_(beyond_m) {}

  void operator()(const Sphere& s) {
    for (int axis = 0; axis < 3; ++axis)
      arc(s.center, (s.radius_m + beyond_m_) * Vec3::Unit(axis), (s.radius_m + beyond_m_) * Vec3::Unit((axis + 1) % 3));
  }
  void operator()(const Ellipsoid& e) {
    for (int axis = 0; axis < 3; ++axis)
      arc(e.center, e.half_m[axis] * e.axes.col(axis), e.half_m[(axis + 1) % 3] * e.axes.col((axis + 1) % 3));
  }
  void operator()(const Box& b) {
    if (beyond_m_ > 0) rounded_box(b.center, b.axes, b.half_m);
    else box(b.center, b.axes * b.half_m.asDiagonal());
  }
  void operator()(const Capsule& c) {
    const double radius_m = c.radius_m + beyond_m_;
    const auto [u, v] = across(c.b - c.a, radius_m);
    const Vec3 along = radius_m * (c.b - c.a).stableNormalized();
    for (const auto& [end, out] : {std::pair(c.a, Vec3(-along)), std::pair(c.b, along)}) {
      arc(end, u, v);
      arc(end, u, out, 0.5);
      arc(end, v, out, 0.5);
    }
    sides(c.a, c.b, u, v, 1);
  }
  void operator()(const Cylinder& c) {
    if (beyond_m_ > 0) return rounded_cylinder(c);
    const auto [u, v] = across(c.b - c.a, c.radius_m);
    arc(c.a, u, v);
    arc(c.b, u, v);
    sides(c.a, c.b, u, v, 1);
  }
  void operator()(const Cone& c) {
    const auto [u, v] = across(c.apex - c.base, c.radius_m);
    arc(c.base, u, v);
    sides(c.base, c.apex, u, v, 0);
  }
  void operator()(const Hull& hull) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < hull.mesh->vertices.size(); ++i) points.push_back(vertex_of(hull, i));
    edges(points, hull.mesh->triangles);
  }
  void operator()(const HalfSpace& h) {
    const Vec3 n = h.normal.stableNormalized();
    const auto [u, v] = across(n, kPlaneReach_m);
    const Vec3 at = h.point + beyond_m_ * n;
    lines_.push_back({at + u + v, at + u - v, at - u - v, at - u + v, at + u + v});
    lines_.push_back({at, at + 0.1 * kPlaneReach_m * n});
  }
  void mesh(const TriangleMesh& mesh) { edges(mesh.vertices, mesh.triangles); }

  /// The box grown by the band's distance: in each middle plane a rectangle with round corners.
  void rounded_box(const Vec3& center, const Mat3& axes, const Vec3& half_m) {
    for (int axis = 0; axis < 3; ++axis) {
      const int next = (axis + 1) % 3;
      rounded_rectangle(center, axes.col(axis), half_m[axis], axes.col(next), half_m[next]);
    }
  }
  void box(const Vec3& center, const Mat3& sides) {
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 u = sides.col((axis + 1) % 3);
      const Vec3 v = sides.col((axis + 2) % 3);
      for (const auto& [a, b] : {std::pair(1, 1), std::pair(1, -1), std::pair(-1, -1), std::pair(-1, 1)}) {
        const Vec3 corner = center + a * u + b * v;
        lines_.push_back({corner - sides.col(axis), corner + sides.col(axis)});
      }
    }
  }
  std::vector<Polyline> take() && { return std::move(lines_); }

 private:
  /// The rectangle around a centre along two unit vectors, grown by the band's distance.
  void rounded_rectangle(const Vec3& center, const Vec3& u, double half_u_m, const Vec3& v, double half_v_m) {
    constexpr int kCornerPieces = kCirclePieces / 4;
    Polyline line;
    for (int corner = 0; corner < 4; ++corner) {
      const double side_u_m = (corner == 0 || corner == 3 ? 1 : -1) * half_u_m;
      const double side_v_m = (corner < 2 ? 1 : -1) * half_v_m;
      for (int i = 0; i <= kCornerPieces; ++i) {
        const double turn = 0.5 * std::numbers::pi * (corner + static_cast<double>(i) / kCornerPieces);
        line.push_back(center + (side_u_m + beyond_m_ * std::cos(turn)) * u +
                       (side_v_m + beyond_m_ * std::sin(turn)) * v);
      }
    }
    line.push_back(line.front());
    lines_.push_back(std::move(line));
  }
  /// The cylinder grown by the band's distance: wider between its ends, with its flat ends farther out and round rims.
  void rounded_cylinder(const Cylinder& c) {
    const Vec3 along = direction(c.b - c.a);
    const auto [u, v] = across(c.b - c.a, 1);
    for (const auto& [end, out] : {std::pair(c.a, Vec3(-along)), std::pair(c.b, along)}) {
      arc(end, (c.radius_m + beyond_m_) * u, (c.radius_m + beyond_m_) * v);
      arc(end + beyond_m_ * out, c.radius_m * u, c.radius_m * v);
    }
    for (const Vec3& side : {u, v})
      rounded_rectangle(0.5 * (c.a + c.b), along, 0.5 * (c.b - c.a).norm(), side, c.radius_m);
  }
  static Vec3 direction(const Vec3& axis) { return axis.isZero(0) ? Vec3::UnitZ() : Vec3(axis.stableNormalized()); }
  /// Two vectors of that length, perpendicular to the axis and to each other.
  static std::pair<Vec3, Vec3> across(const Vec3& axis, double length_m) {
    const Vec3 n = direction(axis);
    const Vec3 u = n.unitOrthogonal();
    return {length_m * u, length_m * n.cross(u)};
  }
  /// center + cos u + sin v over that fraction of a turn.
  void arc(const Vec3& center, const Vec3& u, const Vec3& v, double turns = 1) {
    Polyline line;
    const int pieces = std::max(1, static_cast<int>(kCirclePieces * turns));
    for (int i = 0; i <= pieces; ++i) {
      const double turn = 2 * std::numbers::pi * turns * i / pieces;
      line.push_back(center + std::cos(turn) * u + std::sin(turn) * v);
    }
    lines_.push_back(std::move(line));
  }
  /// Four lines between the rims of two ends.
  void sides(const Vec3& from, const Vec3& to, const Vec3& u, const Vec3& v, double width_at_end) {
    for (const Vec3& out : {u, v, Vec3(-u), Vec3(-v)}) lines_.push_back({from + out, to + width_at_end * out});
  }
  template <class Points, class Triangles>
  void edges(const Points& points, const Triangles& triangles) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<Vec3>> normals;
    for (const auto& corners : triangles) {
      const Vec3 normal = (points[corners[1]] - points[corners[0]]).cross(points[corners[2]] - points[corners[0]]);
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = corners[i];
        const std::uint32_t b = corners[(i + 1) % 3];
        normals[{std::min(a, b), std::max(a, b)}].push_back(normal.stableNormalized());
      }
    }
    std::vector<Polyline> found;
    for (const auto& [ends, of] : normals) {
      if (of.size() == 2 && of[0].dot(of[1]) > kFlat) continue;
      found.push_back({points[ends.first], points[ends.second]});
    }
    if (found.size() <= kMostEdges) {
      lines_.insert(lines_.end(), found.begin(), found.end());
      return;
    }
    Aabb box;
    for (const Vec3& point : points) box.extend(point);
    this->box(0.5 * (box.low + box.high), (0.5 * (box.high - box.low)).asDiagonal().toDenseMatrix());
  }

  double beyond_m_;
  std::vector<Polyline> lines_;
};

/// True if the outline of a band is that of the body grown by its distance, not of a box around it.
bool is_drawn_as_grown(const ObjectInfo& body) {
  if (body.primitives.size() != 1 || body.mesh) return false;
  const Primitive& shape = body.primitives.front();
  return std::holds_alternative<Sphere>(shape) || std::holds_alternative<HalfSpace>(shape) ||
         std::holds_alternative<Box>(shape) || std::holds_alternative<Capsule>(shape) ||
         std::holds_alternative<Cylinder>(shape);
}

}  // namespace

std::vector<Polyline> outline_of(const ObjectInfo& body, double beyond_m) {
  Outline outline(beyond_m);
  if (beyond_m > 0 && !is_drawn_as_grown(body)) {
    const Aabb box = bounds_of(body, Frame{});
    if (box.low.allFinite() && box.high.allFinite())
      outline.rounded_box(0.5 * (box.low + box.high), Mat3::Identity(), 0.5 * (box.high - box.low));
    return std::move(outline).take();
  }
  for (const Primitive& primitive : body.primitives) std::visit(outline, primitive);
  if (body.mesh) outline.mesh(*body.mesh->mesh);
  return std::move(outline).take();
}

}  // namespace collided::engine
