#include "server/exact_phase/round_solids/plane_conics.hpp"

#include "server/exact_phase/arithmetic/real_root.hpp"

namespace collided::engine::kernel {

Decision ellipses_meet(const Conic& a, const Conic& b) {
  const auto entry = [&](std::size_t i, std::size_t j) { return ExactRayPolynomial(b[i][j], a[i][j]); };
  const auto minor = [&](std::size_t i, std::size_t j) {
    return entry(1, i) * entry(2, j) - entry(1, j) * entry(2, i);
  };
  ExactRayPolynomial sum = entry(0, 0) * minor(1, 2) - entry(0, 1) * minor(0, 2) + entry(0, 2) * minor(0, 1);
  sum.trim();
  const RealRoots positive = roots_from_zero(sum);
  if (positive.roots.size() == 2) return Decision::no;
  return positive.complete ? Decision::yes : Decision::undecided;
}

AcrossAxis::AcrossAxis(const Convex& set, int end)
    : from(set.carrier[end]),
      axis(Vector<Dyadic>(set.carrier[1]) - Vector<Dyadic>(set.carrier[0])),
      radius(set.disc_m > 0 ? set.disc_m : set.ball_m) {
  int least = 0;
  (set.carrier[1] - set.carrier[0]).cwiseAbs().minCoeff(&least);
  u = cross(axis, Vector<Dyadic>(Vec3(Vec3::Unit(least))));
  v = cross(axis, u);
}

Conic disc_in_shares(const AcrossAxis& plane) {
  Conic conic;
  conic[0][0] = square(plane.u);
  conic[1][1] = square(plane.v);
  conic[2][2] = -(plane.radius * plane.radius);
  return conic;
}

Conic disc_in_products(const AcrossAxis& plane) {
  Conic conic;
  conic[0][0] = square(plane.v);
  conic[1][1] = square(plane.u);
  conic[2][2] = -(plane.radius * plane.radius * (square(plane.u) * square(plane.v)));
  return conic;
}

}  // namespace collided::engine::kernel
