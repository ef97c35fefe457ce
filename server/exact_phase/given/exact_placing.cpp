#include "server/exact_phase/given/exact_placing.hpp"

#include "server/exact_phase/distance/polytope_kernel.hpp"

namespace collided::engine {
namespace {

using kernel::dot;
using kernel::ExactSolid;
using kernel::FlatFeatures;
using kernel::square;
using Point = kernel::Vector<Dyadic>;

/// q v q*, which is |q|^2 times the rotated vector.
class ExactTurn {
 public:
  explicit ExactTurn(const Quat& q) : w_(q.w()), v_(q.x(), q.y(), q.z()), norm2_(w_ * w_ + square(v_)) {}

  const Dyadic& norm2() const { return norm2_; }
  /// (w^2 - v.v) p + 2 (v.p) v + 2 w (v x p)
  Point operator()(const Point& p) const {
    const Dyadic two(2.0);
    return (w_ * w_ - square(v_)) * p + two * dot(v_, p) * v_ + two * w_ * cross(v_, p);
  }

 private:
  Dyadic w_;
  Point v_;
  Dyadic norm2_;
};

Point exact(const Vec3& v) { return Point(v); }

ExactSolid with_ends(std::vector<Point> points, Dyadic radius, ExactSolid::Kind kind) {
  ExactSolid solid;
  solid.kind = radius.sign() > 0 ? kind : ExactSolid::Kind::flat;
  solid.points = std::move(points);
  solid.radius = std::move(radius);
  // A point or a segment is its own border.
  if (solid.kind == ExactSolid::Kind::flat)
    solid.border.emplace().edges.push_back({0, static_cast<std::uint32_t>(solid.points.size() - 1)});
  return solid;
}

/// Places the part's corners by its pose, all coordinates times `scale` and times |q|^2.
class Placer {
 public:
  using Kind = ExactSolid::Kind;

  Placer(const Pose& pose, Dyadic scale, bool with_border)
      : turn_(pose.rotation),
        scale_(std::move(scale)),
        length_(turn_.norm2() * scale_),
        to_(length_ * exact(pose.position)),
        with_border_(with_border) {}

  Point point(const Point& own) const { return direction(own) + to_; }
  Point direction(const Point& own) const { return scale_ * turn_(own); }
  Dyadic length(double own) const { return Dyadic(own) * length_; }

  ExactPart operator()(const Sphere& s) const {
    return with_ends({point(exact(s.center))}, length(s.radius_m), Kind::ball);
  }
  ExactPart operator()(const Capsule& c) const {
    return with_ends({point(exact(c.a)), point(exact(c.b))}, length(c.radius_m), Kind::capsule);
  }
  ExactPart operator()(const Box& box) const { return flat(kernel::Convex(box)); }
  ExactPart operator()(const Hull& hull) const { return flat(kernel::Convex(hull)); }
  ExactPart operator()(const Triangle& t) const { return flat(kernel::Convex(t)); }
  ExactPart operator()(const HalfSpace& h) const { return Ground{point(exact(h.point)), direction(exact(h.normal))}; }
  ExactPart operator()(const Cylinder& c) const {
    return with_ends({point(exact(c.a)), point(exact(c.b))}, length(c.radius_m), Kind::axial);
  }
  ExactPart operator()(const Cone& c) const {
    ExactSolid cone = with_ends({point(exact(c.apex)), point(exact(c.base))}, length(c.radius_m), Kind::axial);
    cone.first_disc = cone.kind == Kind::axial ? 1 : 0;
    return cone;
  }
  ExactPart operator()(const Ellipsoid& e) const {
    ExactSolid solid;
    solid.kind = Kind::ellipsoid;
    solid.points = {point(exact(e.center))};
    for (int i = 0; i < 3; ++i) solid.half[i] = direction(Dyadic(e.half_m[i]) * exact(e.axes.col(i)));
    return solid;
  }

 private:
  ExactSolid flat(const kernel::Convex& own) const {
    ExactSolid solid;
    const std::optional<FlatFeatures> features = with_border_ ? FlatFeatures::of(own) : std::nullopt;
    if (!features) {
      solid.points = kernel::corners_of(own);
    } else {
      for (std::uint32_t i = 0; i < features->corner_count(); ++i)
        solid.points.push_back(features->corner<Dyadic>(i, Vec3::Zero()));
      solid.border = features->border();
    }
    for (Point& corner : solid.points) corner = point(corner);
    return solid;
  }

  ExactTurn turn_;
  Dyadic scale_;
  Dyadic length_;
  Point to_;
  bool with_border_;
};

bool is_axial(const ConvexPart& part) {
  const auto* primitive = std::get_if<Primitive>(&part);
  return primitive != nullptr &&
         (std::holds_alternative<Cylinder>(*primitive) || std::holds_alternative<Cone>(*primitive));
}

}  // namespace

Dyadic square_norm(const Quat& q) { return ExactTurn(q).norm2(); }

ExactPart exactly_placed(const ConvexPart& own, const Pose& pose, const Dyadic& scale, const ConvexPart& against) {
  const Placer place(pose, scale, is_axial(against));
  if (const auto* triangle = std::get_if<Triangle>(&own)) return place(*triangle);
  return std::visit(place, std::get<Primitive>(own));
}

}  // namespace collided::engine
