#include "server/exact_phase/round_solids/disc_exact.hpp"

#include "server/exact_phase/round_solids/plane_conics.hpp"

namespace collided::engine::kernel {
namespace {

using Point = Vector<Dyadic>;

/// Whether |g| <= sqrt(p) + sqrt(q); no if a root does not exist.
bool within_roots(const Dyadic& g, const Dyadic& p, const Dyadic& q) {
  if (p.sign() < 0 || q.sign() < 0) return false;
  const Dyadic rest = g * g - p - q;
  return rest.sign() <= 0 || (rest * rest - Dyadic(4.0) * p * q).sign() <= 0;
}

Decision decided(bool yes) { return yes ? Decision::yes : Decision::no; }

}  // namespace

/// Both discs cut the common line of their planes, each in a segment around the foot of its centre.
Decision discs_meet(const ExactSolid& a, int end_a, const ExactSolid& b, int end_b) {
  const AcrossAxis of_a(a, end_a);
  const AcrossAxis of_b(b, end_b);
  const Point w = of_a.from - of_b.from;
  const Point line = cross(of_a.axis, of_b.axis);
  const Dyadic line2 = square(line);
  if (!of_a.is_usable() || !of_b.is_usable() || !square(w).finite() || !line2.finite()) return Decision::undecided;
  if (line2.sign() == 0) {
    const Dyadic reach = of_a.radius + of_b.radius;
    return decided(dot(of_a.axis, w).sign() == 0 && (square(w) - reach * reach).sign() <= 0);
  }
  const Dyadic off_a = dot(of_b.axis, w);
  const Dyadic off_b = dot(of_a.axis, w);
  const Dyadic piece_a = of_a.radius * of_a.radius * line2 - off_a * off_a * square(of_a.axis);
  const Dyadic piece_b = of_b.radius * of_b.radius * line2 - off_b * off_b * square(of_b.axis);
  return decided(within_roots(dot(w, line), piece_a, piece_b));
}

/// The disc's plane cuts the infinite cylinder in an ellipse, or in a strip if it is parallel to the axis.
Decision disc_meets_endless(const ExactSolid& cylinder, int end, const ExactSolid& side) {
  const AcrossAxis disc(cylinder, end);
  const AcrossAxis other(side, 0);
  const Point w = disc.from - other.from;
  const Point& e = other.axis;
  if (!disc.is_usable() || !other.is_usable() || !square(w).finite()) return Decision::undecided;
  if (dot(disc.axis, e).sign() == 0) {
    const Point across = cross(e, disc.axis);
    const Dyadic height = dot(disc.axis, w);
    const Dyadic strip = (other.radius * other.radius * square(disc.axis) - height * height) * square(e);
    return decided(within_roots(dot(across, w), disc.radius * disc.radius * square(across), strip));
  }
  const Point column[3] = {cross(disc.u, e), cross(disc.v, e), cross(w, e)};
  Conic section;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) section[i][j] = dot(column[i], column[j]);
  }
  section[2][2] = section[2][2] - other.radius * other.radius * square(e);
  return ellipses_meet(section, disc_in_shares(disc));
}

}  // namespace collided::engine::kernel
