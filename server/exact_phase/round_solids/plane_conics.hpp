#pragma once

#include <array>

#include "server/exact_phase/distance/convex.hpp"

namespace collided::engine::kernel {

/// In a plane: (y, 1) Q (y, 1) is negative inside.
using Conic = std::array<std::array<Dyadic, 3>, 3>;

/// Two ellipses with an inside each. By rationals alone.
/// source  as ellipsoids_meet: apart where det(x A + B) has two different positive roots
Decision ellipses_meet(const Conic& a, const Conic& b);

/// Two directions across the axis of a cylinder or capsule and each other, from one of its ends, and its radius.
struct AcrossAxis {
  Vector<Dyadic> from;
  Vector<Dyadic> axis;
  Vector<Dyadic> u;
  Vector<Dyadic> v;
  Dyadic radius;

  AcrossAxis(const Convex& set, int end);
  bool is_usable() const { return square(v).finite() && radius.finite() && square(v).sign() > 0 && radius.sign() > 0; }
};

/// The disc of the radius, of points from + s u + t v.
Conic disc_in_shares(const AcrossAxis& plane);
/// The same of points whose products with u and v, from `from`, are y.
Conic disc_in_products(const AcrossAxis& plane);

}  // namespace collided::engine::kernel
