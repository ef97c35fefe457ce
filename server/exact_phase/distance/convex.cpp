#include "server/exact_phase/distance/convex.hpp"

#include <algorithm>
#include <cmath>

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/stable_length.hpp"

namespace collided::engine::kernel {
namespace {

/// Approximate farthest point of the disc of radius 1 perpendicular to the axis. Made perpendicular twice, because the
/// first time cancels digits if n runs almost along the axis; then the disc's centre is as good.
Vec3 disc_support(const Vec3& n, const Vec3& d) {
  Vec3 across = n - n.dot(d) * d;
  const double length2 = across.squaredNorm();
  const double whole2 = n.squaredNorm();
  if (!(length2 > kDiscSeenFlat * kDiscSeenFlat * whole2)) return Vec3::Zero();
  across /= std::sqrt(length2);
  // At 30 degrees to the axis and more the first time is off by 5 u of |n|, 10 u of the perpendicular part, and 4 u for
  // the unit vector: within kSupportError.
  if (length2 > 0.25 * whole2) return across;
  across -= across.dot(d) * d;
  return across / across.norm();
}

Bounded value_of(const ReachPart<Bounded>& part) {
  const bool no_root = part.numerator.exactly_zero();
  return no_root ? part.rational : part.rational + sqrt(part.numerator / part.denominator);
}

Bounded farthest_of(const ReachAlong<Bounded>& reach) {
  const Bounded first = value_of(reach.part[0]);
  return reach.count == 1 ? first : max(first, value_of(reach.part[1]));
}

bool is_plain_box(const Convex& set) {
  return set.plus == Convex::Plus::box && set.count() == 1 && set.hull == nullptr && !(set.ball_m > 0) &&
         !(set.disc_m > 0);
}

/// reach_along() of a box, whose axes and halves are exact, in Bounded: the same operations in the same order without
/// those that have no effect for an exact factor, which changes no bit of a finite result. n: for either side.
Bounded reach_of_box(const Convex& box, const Vec3& n, const Vec3& origin) {
  const auto product = [](double a, double b) {
    const double value = a * b;
    return Bounded(value, kRoundoff * std::abs(value) + (a == 0 || b == 0 ? 0.0 : kUnderflow));
  };
  const auto away = [&](int k) { return times(Bounded(box.carrier[0][k]) - Bounded(origin[k]), n[k]); };
  Bounded reach = (away(0) + away(1)) + away(2);
  for (int i = 0; i < 3; ++i) {
    const double* axis = box.axes.data() + 3 * i;
    const Bounded over = (product(n[0], axis[0]) + product(n[1], axis[1])) + product(n[2], axis[2]);
    reach = reach + abs(times(over, box.half_m[i]));
  }
  return reach;
}

}  // namespace

Convex::Convex(const Sphere& s) : carrier{s.center}, ball_m(s.radius_m) {}

Convex::Convex(const Box& b) : carrier{b.center}, plus(Plus::box), axes(b.axes), half_m(b.half_m) {
  reach_m = (axes * half_m.asDiagonal()).cwiseAbs().sum();
}

Convex::Convex(const Capsule& c)
    : carrier{c.a, c.b}, carrier_count(2), ball_m(c.radius_m), reach_m((c.b - c.a).stableNorm()) {}

Convex::Convex(const Triangle& t)
    : carrier{t.a, t.b, t.c}, carrier_count(3), reach_m(std::max((t.b - t.a).stableNorm(), (t.c - t.a).stableNorm())) {}

Convex::Convex(const Cylinder& c)
    : carrier{c.a, c.b},
      carrier_count(2),
      disc_m(c.radius_m),
      disc_axis{c.b, c.a},
      disc_unit((c.b - c.a).stableNormalized()),
      reach_m((c.b - c.a).stableNorm() + c.radius_m) {}

Convex::Convex(const Cone& c)
    : carrier{c.apex, c.base},
      carrier_count(2),
      disc_m(c.radius_m),
      first_disc(1),
      disc_axis{c.base, c.apex},
      disc_unit((c.base - c.apex).stableNormalized()),
      reach_m((c.base - c.apex).stableNorm() + c.radius_m) {}

Convex::Convex(const Ellipsoid& e) : carrier{e.center}, plus(Plus::ellipsoid), axes(e.axes), half_m(e.half_m) {
  reach_m = (axes * half_m.asDiagonal()).cwiseAbs().sum();
}

Convex::Convex(const Hull& h)
    : carrier{vertex_of(h, 0)}, hull(&h), hull_count(static_cast<int>(h.mesh->vertices.size())) {
  // Measured in the hull's own frame: rotation and rounding change only the last digits.
  const std::vector<Vec3>& vertices = h.mesh->vertices;
  double reach = 0;
  Vec3 sum = Vec3::Zero();
  for (const Vec3& vertex : vertices) {
    const Vec3 away = vertex - vertices[0];
    reach = std::max(reach, away.cwiseAbs().maxCoeff());
    sum += away;
  }
  hull_middle_ = h.rotation * (sum / static_cast<double>(vertices.size()));
  reach_m = 1.75 * reach + 16 * kRoundoff * carrier[0].cwiseAbs().maxCoeff();
}

Vec3 Convex::middle() const {
  if (hull != nullptr) return hull_middle_;
  if (carrier_count == 2) return (carrier[1] - carrier[0]) / 2;
  return carrier_count == 3 ? Vec3(((carrier[1] - carrier[0]) + (carrier[2] - carrier[0])) / 3) : Vec3(Vec3::Zero());
}

Vec3 Convex::point(int i) const { return hull == nullptr ? carrier[i] : vertex_of(*hull, static_cast<std::size_t>(i)); }

Vec3 Convex::support(const Vec3& n) const {
  Vec3 best = Vec3::Zero();
  double most = 0;
  // Both discs of a cylinder are alike, so the carriers can be compared with the disc added.
  const Vec3 disc = disc_m > 0 ? Vec3(disc_m * disc_support(n, disc_unit)) : Vec3(Vec3::Zero());
  if (hull != nullptr) {
    // The vertex farthest along n in the hull's own frame.
    const Vec3 own = hull->rotation.transpose() * n;
    const std::vector<Vec3>& vertices = hull->mesh->vertices;
    std::size_t farthest = 0;
    double reached = own.dot(vertices[0]);
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      const double here = own.dot(vertices[i]);
      farthest = here > reached ? i : farthest;
      reached = std::max(reached, here);
    }
    return vertex_of(*hull, farthest) - carrier[0];
  }
  for (int i = 0; i < carrier_count; ++i) {
    Vec3 here = carrier[i] - carrier[0];
    if (i >= first_disc) here += disc;
    const double along = n.dot(here);
    if (i > 0 && !(along > most)) continue;
    best = here;
    most = along;
  }
  if (plus == Plus::box) {
    for (int i = 0; i < 3; ++i) best += std::copysign(half_m[i], n.dot(axes.col(i))) * axes.col(i);
  } else if (plus == Plus::ellipsoid) {
    const Vec3 own = half_m.cwiseProduct(axes.transpose() * n);
    const double length = stable_length(own);
    if (length > 0) best += axes * half_m.cwiseProduct(own / length);
  }
  return best;
}

Bounded reach_value(const Convex& set, const Vec3& n, int side, const Vec3& origin) {
  if (is_plain_box(set)) return reach_of_box(set, side > 0 ? n : Vec3(-n), origin);
  return farthest_of(reach_along<Bounded>(set, n, side, origin));
}

Bounded push_along(const Vec3& n, const Convex& a, const Convex& b) {
  const Vec3& origin = b.carrier[0];
  const Bounded forward = reach_value(a, n, +1, origin) + reach_value(b, n, -1, origin);
  return forward / sqrt(square(Vector<Bounded>(n)));
}

}  // namespace collided::engine::kernel
