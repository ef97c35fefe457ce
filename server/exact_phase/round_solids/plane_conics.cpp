#include "server/exact_phase/round_solids/plane_conics.hpp"

#include <algorithm>

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

AcrossAxis::AcrossAxis(const ExactSolid& set, int end)
    : from(set.points[static_cast<std::size_t>(end)]), axis(set.axis()), radius(set.radius) {
  const std::array<Dyadic, 3> along{abs(axis.x), abs(axis.y), abs(axis.z)};
  const auto least = std::min_element(along.begin(), along.end(),
                                      [](const Dyadic& a, const Dyadic& b) { return (a - b).sign() < 0; }) -
                     along.begin();
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
