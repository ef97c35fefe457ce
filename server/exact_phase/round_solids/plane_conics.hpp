#pragma once

#include <array>

#include "server/exact_phase/round_solids/exact_solid.hpp"

namespace collided::engine::kernel {

/// A conic in a plane: (y, 1) Q (y, 1) is negative inside.
using Conic = std::array<std::array<Dyadic, 3>, 3>;

/// Whether two ellipses, each with an interior, share a point. By rationals alone.
/// source  as ellipsoids_meet: separate if det(x A + B) has two different positive roots
Decision ellipses_meet(const Conic& a, const Conic& b);

/// Two directions perpendicular to the axis of a cylinder or capsule and to each other, starting at one of its ends,
/// and its radius.
struct AcrossAxis {
  Vector<Dyadic> from;
  Vector<Dyadic> axis;
  Vector<Dyadic> u;
  Vector<Dyadic> v;
  Dyadic radius;

  AcrossAxis(const ExactSolid& set, int end);
  bool is_usable() const { return square(v).finite() && radius.finite() && square(v).sign() > 0 && radius.sign() > 0; }
};

/// The disc of that radius, in coordinates s, t of the points from + s u + t v.
Conic disc_in_shares(const AcrossAxis& plane);
/// The disc in coordinates y: the products of a point, relative to `from`, with u and v.
Conic disc_in_products(const AcrossAxis& plane);

}  // namespace collided::engine::kernel
