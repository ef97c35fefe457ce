#include "server/exact_phase/given/given_overlap.hpp"

#include <optional>
#include <vector>

#include "server/exact_phase/distance/polytope_kernel.hpp"
#include "server/geometry/mesh.hpp"

namespace collided::engine {
namespace {

using Point = kernel::Vector<Dyadic>;
using kernel::dot;
using kernel::square;

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

/// The hull of a few points with a ball around each.
struct Rounded {
  std::vector<Point> corners;
  Dyadic radius;
};

/// All points whose product with the normal is at most that of `point`.
struct Ground {
  Point point;
  Point normal;
};

/// A disc, or two: all points within `radius` of one of the centres in the plane through it that `axis` is perpendicular
/// to. With `apex`, the hull with that point.
struct Discs {
  std::vector<Point> centers;
  Point axis;
  Dyadic radius;
  std::optional<Point> apex;
};

/// The images of the unit ball under three half axes.
struct UnitBallImage {
  Point center;
  Point half[3];
};

using ExactPart = std::variant<Rounded, Ground, Discs, UnitBallImage>;

Point exact(const Vec3& v) { return Point(v); }

/// The part with its corners where its pose puts them, all coordinates times `scale` and times |q|^2.
class Placer {
 public:
  Placer(const Pose& pose, Dyadic scale)
      : turn_(pose.rotation),
        scale_(std::move(scale)),
        length_(turn_.norm2() * scale_),
        to_(length_ * exact(pose.position)) {}

  Point point(const Point& own) const { return direction(own) + to_; }
  Point direction(const Point& own) const { return scale_ * turn_(own); }
  Dyadic length(double own) const { return Dyadic(own) * length_; }

  ExactPart operator()(const Sphere& s) const { return Rounded{{point(exact(s.center))}, length(s.radius_m)}; }
  ExactPart operator()(const Capsule& c) const {
    return Rounded{{point(exact(c.a)), point(exact(c.b))}, length(c.radius_m)};
  }
  ExactPart operator()(const Box& box) const { return corners(kernel::corners_of(kernel::Convex(box))); }
  ExactPart operator()(const Hull& hull) const { return corners(kernel::corners_of(kernel::Convex(hull))); }
  ExactPart operator()(const Triangle& t) const { return corners({exact(t.a), exact(t.b), exact(t.c)}); }
  ExactPart operator()(const HalfSpace& h) const { return Ground{point(exact(h.point)), direction(exact(h.normal))}; }
  ExactPart operator()(const Cylinder& c) const {
    const Point a = exact(c.a);
    const Point b = exact(c.b);
    return Discs{{point(a), point(b)}, direction(b - a), length(c.radius_m), std::nullopt};
  }
  ExactPart operator()(const Cone& c) const {
    const Point apex = exact(c.apex);
    const Point base = exact(c.base);
    return Discs{{point(base)}, direction(base - apex), length(c.radius_m), point(apex)};
  }
  ExactPart operator()(const Ellipsoid& e) const {
    UnitBallImage result{.center = point(exact(e.center)), .half = {}};
    for (int i = 0; i < 3; ++i) result.half[i] = direction(Dyadic(e.half_m[i]) * exact(e.axes.col(i)));
    return result;
  }

 private:
  Rounded corners(std::vector<Point> own) const {
    for (Point& corner : own) corner = point(corner);
    return {std::move(own), Dyadic()};
  }

  ExactTurn turn_;
  Dyadic scale_;
  Dyadic length_;
  Point to_;
};

const Pose& pose_of(const GivenPart& part) {
  static const Pose nowhere;
  return part.pose != nullptr ? *part.pose : nowhere;
}

ExactPart placed(const ConvexPart& in_world, const GivenPart& given, const Dyadic& scale) {
  const Placer place(pose_of(given), scale);
  if (const auto* triangle = std::get_if<Triangle>(&given.own)) return place(*triangle);
  if (const auto* const* own = std::get_if<const Primitive*>(&given.own)) return std::visit(place, **own);
  if (const auto* triangle = std::get_if<Triangle>(&in_world)) return place(*triangle);
  return std::visit(place, std::get<Primitive>(in_world));
}

/// Whether a set comes down to the ground from its middle at height `above` when it reaches sqrt(reach2) from there, both
/// times the length of the ground's normal.
Decision comes_down(const Dyadic& above, const Dyadic& reach2) {
  if (above.sign() <= 0) return Decision::yes;
  return kernel::at_most(above * above, reach2);
}

Decision meets(const Ground& ground, const Rounded& part) {
  const Dyadic reach2 = part.radius * part.radius * square(ground.normal);
  for (const Point& corner : part.corners) {
    if (comes_down(dot(ground.normal, corner - ground.point), reach2) == Decision::yes) return Decision::yes;
  }
  return Decision::no;
}

Decision meets(const Ground& ground, const Discs& part) {
  if (part.apex && dot(ground.normal, *part.apex - ground.point).sign() <= 0) return Decision::yes;
  // A disc reaches radius |n x axis| / |axis| along n; both sides are multiplied by |axis|^2 once squared.
  const Dyadic axis2 = square(part.axis);
  const Dyadic reach2 = part.radius * part.radius * square(cross(ground.normal, part.axis));
  for (const Point& center : part.centers) {
    const Dyadic above = dot(ground.normal, center - ground.point);
    if (above.sign() <= 0 || kernel::at_most(above * above * axis2, reach2) == Decision::yes) return Decision::yes;
  }
  return Decision::no;
}

Decision meets(const Ground& ground, const UnitBallImage& part) {
  Dyadic reach2;
  for (const Point& half : part.half) {
    const Dyadic along = dot(ground.normal, half);
    reach2 = reach2 + along * along;
  }
  return comes_down(dot(ground.normal, part.center - ground.point), reach2);
}

Decision meets(const Rounded& a, const Rounded& b) {
  return kernel::hulls_meet(a.corners, b.corners, a.radius + b.radius);
}

/// Pairs of round solids, and of two half-spaces, have no test here.
Decision meets(const auto&, const auto&) { return Decision::undecided; }

}  // namespace

Decision overlaps_as_given(const ConvexPart& placed_a, const ConvexPart& placed_b, const GivenPair& given) {
  const ExactPart a = placed(placed_a, given.a, ExactTurn(pose_of(given.b).rotation).norm2());
  const ExactPart b = placed(placed_b, given.b, ExactTurn(pose_of(given.a).rotation).norm2());
  return std::visit(
      [](const auto& first, const auto& second) {
        if constexpr (std::is_same_v<std::decay_t<decltype(second)>, Ground>) return meets(second, first);
        else return meets(first, second);
      },
      a, b);
}

}  // namespace collided::engine
