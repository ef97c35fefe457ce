#include "server/intake/mesh/shape_scale.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <string_view>

#include "idl/question_rules.hpp"
#include "server/geometry/aabb.hpp"
#include "server/geometry/convex_hull.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {
namespace {

class Scaling {
 public:
  explicit Scaling(const Vec3& factor) : factor_(factor), even_(factor[0] == factor[1] && factor[1] == factor[2]) {}

  void apply(Sphere& s) {
    need_even("a sphere", "an ellipsoid");
    s = {point(s.center), length(s.radius_m)};
  }
  void apply(Capsule& c) {
    need_even("a capsule", "no capsule");
    c = {point(c.a), point(c.b), length(c.radius_m)};
  }
  void apply(Cylinder& c) {
    need_even("a cylinder", "no cylinder");
    c = {point(c.a), point(c.b), length(c.radius_m)};
    need(c.a != c.b, "a cylinder would have no length");
  }
  void apply(Cone& c) {
    need_even("a cone", "no cone");
    c = {point(c.apex), point(c.base), length(c.radius_m)};
    need(c.apex != c.base, "a cone would have no height");
  }
  void apply(Box& b) {
    need(even_ || lies_along_axes(b.axes), "a turned box would become no box; one factor for all axes is allowed");
    b = {point(b.center), b.axes, halves(b.axes, b.half_m)};
  }
  void apply(Ellipsoid& e) {
    need(even_ || lies_along_axes(e.axes),
         "a turned ellipsoid would get other axes; one factor for all axes is allowed");
    e = {point(e.center), e.axes, halves(e.axes, e.half_m)};
    need((e.half_m.array() > 0).all(), "an ellipsoid would have no thickness");
  }
  void apply(HalfSpace& h) {
    need_even("a half-space", "another normal");
    h.point = point(h.point);
  }
  void apply(Hull& h) {
    // The hull is computed again: rounding may have moved a corner inside, or all of them into one plane.
    std::optional<TriangleMesh> hull = convex_hull(scaled(*h.mesh)->vertices);
    need(hull.has_value(), "the corners of a hull would lie in one plane, or beyond the range of exact arithmetic");
    if (hull) h.mesh = std::make_shared<const TriangleMesh>(std::move(*hull));
  }

  std::shared_ptr<const TriangleMesh> scaled(const TriangleMesh& mesh) {
    auto copy = std::make_shared<TriangleMesh>(mesh);
    for (Vec3& vertex : copy->vertices) vertex = point(vertex);
    return copy;
  }
  std::string refusal() { return std::move(refusal_); }

 private:
  static bool lies_along_axes(const Mat3& axes) { return ((axes.array() == 0) || (axes.array().abs() == 1)).all(); }
  void need(bool good, std::string_view otherwise) {
    if (!good && refusal_.empty()) {
      refusal_ = fmt::format("scale ({}, {}, {}): {}", factor_[0], factor_[1], factor_[2], otherwise);
    }
  }
  void need_even(std::string_view kind, std::string_view becomes) {
    need(even_, fmt::format("{} would become {}; one factor for all axes is allowed", kind, becomes));
  }
  Vec3 point(const Vec3& p) {
    const Vec3 product = p.cwiseProduct(factor_);
    need(wire_contract::are_coordinates(product), "a coordinate would exceed 1e290 m");
    return product;
  }
  double length(double l) {
    need(wire_contract::is_coordinate(l * factor_[0]), "a length would exceed 1e290 m");
    return l * factor_[0];
  }
  Vec3 halves(const Mat3& axes, const Vec3& half_m) {
    // For an axis-aligned box each column has one entry that is not 0, which selects the factor.
    const Vec3 own = even_ ? factor_ : Vec3(axes.cwiseAbs().transpose() * factor_);
    const Vec3 product = half_m.cwiseProduct(own);
    need(wire_contract::are_coordinates(product), "a length would exceed 1e290 m");
    return product;
  }

  Vec3 factor_;
  bool even_;
  std::string refusal_;
};

}  // namespace

std::string scale(Shape& shape, const Vec3& factor) {
  if (!((factor.array() > 0).all() && factor.allFinite())) {
    return fmt::format("scale ({}, {}, {}): factors must be finite and above 0; mirror images are not offered",
                       factor[0], factor[1], factor[2]);
  }
  Scaling scaling(factor);
  for (Primitive& primitive : shape.primitives) {
    std::visit([&](auto& one) { scaling.apply(one); }, primitive);
  }
  if (shape.mesh) shape.mesh = scaling.scaled(*shape.mesh);
  return scaling.refusal();
}

std::string beyond_limit(const Vec3& point) {
  if (wire_contract::are_coordinates(point)) return {};
  return fmt::format("({}, {}, {}) m, allowed are numbers up to 1e290", point[0], point[1], point[2]);
}

std::string beyond_limit(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (std::string reason = beyond_limit(mesh.vertices[i]); !reason.empty())
      return fmt::format("vertex {} is {}", i, reason);
  }
  return {};
}

std::string beyond_limit(const Shape& shape) {
  for (std::size_t i = 0; i < shape.primitives.size(); ++i) {
    const auto* ground = std::get_if<HalfSpace>(&shape.primitives[i]);
    const Aabb box = ground != nullptr ? Aabb{ground->point, ground->point} : bounds(shape.primitives[i]);
    for (const Vec3& corner : {box.low, box.high}) {
      if (std::string reason = beyond_limit(corner); !reason.empty())
        return fmt::format("primitive {} reaches to {}", i, reason);
    }
  }
  return shape.mesh ? beyond_limit(*shape.mesh) : std::string();
}

}  // namespace collided::engine
