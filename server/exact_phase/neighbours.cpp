#include "server/exact_phase/neighbours.hpp"

#include <cmath>

#include "server/exact_phase/number.hpp"
#include "server/exact_phase/overlap.hpp"
#include "server/exact_phase/triple.hpp"

namespace collided {
namespace {

using kernel::Sign;
using kernel::Triple;
using kernel::Vector;

/// Side of the plane through o, p, q on which r lies, where plain double knows; the arguments are seen from o.
int sure_side(const Triple& p, const Triple& q, const Triple& r) {
  const double product = dot(r, cross(p, q));
  const double scale = p.largest() * q.largest() * r.largest();
  // Below, products of differences might underflow; above, overflow.
  if (!(scale >= 0x1p-300 && scale <= 0x1p900)) return 0;
  const double error = kOrientationError * scale;
  return product > error ? 1 : product < -error ? -1 : 0;
}

/// Sign of the turn from p to q seen from o, with one coordinate left out.
template <class N>
Sign turn(const Vec3& o, const Vec3& p, const Vec3& q, int u, int v) {
  return kernel::sign((N(p[u]) - N(o[u])) * (N(q[v]) - N(o[v])) - (N(p[v]) - N(o[v])) * (N(q[u]) - N(o[u])));
}
Sign quick_turn(const Vec3& o, const Vec3& p, const Vec3& q, int u, int v) { return turn<Bounded>(o, p, q, u, v); }

int widest_axis(const Triangle& t) {
  const Triple n = cross(kernel::triple(t.b) - kernel::triple(t.a), kernel::triple(t.c) - kernel::triple(t.a));
  return std::abs(n.x) > std::abs(n.y) ? (std::abs(n.x) > std::abs(n.z) ? 0 : 2)
                                       : (std::abs(n.y) > std::abs(n.z) ? 1 : 2);
}

/// Seen along the axis, p surely lies outside the closed angle from o that the triangle's other corners make.
bool surely_outside(const Triangle& t, bool anticlockwise, const Vec3& p, int u, int v) {
  const Sign wrong = anticlockwise ? Sign::negative : Sign::positive;
  return quick_turn(t.a, t.b, p, u, v) == wrong || quick_turn(t.a, p, t.c, u, v) == wrong;
}

/// Seen along an axis the two angles at the common corner have nothing else in common: nor have the triangles.
bool part_in_projection(const Triangle& a, const Triangle& b) {
  const int axis = widest_axis(a);
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const Sign turn_a = quick_turn(a.a, a.b, a.c, u, v);
  const Sign turn_b = quick_turn(b.a, b.b, b.c, u, v);
  const auto is_sure = [](Sign s) { return s == Sign::positive || s == Sign::negative; };
  if (!is_sure(turn_a) || !is_sure(turn_b)) return false;
  const bool left_a = turn_a == Sign::positive;
  const bool left_b = turn_b == Sign::positive;
  return surely_outside(a, left_a, b.b, u, v) && surely_outside(a, left_a, b.c, u, v) &&
         surely_outside(b, left_b, a.b, u, v) && surely_outside(b, left_b, a.c, u, v);
}

Verdict no() { return {Decision::no, Level::filter}; }

/// On exact numbers: the four points lie in one plane, and seen along the axis a and b lie on one side of o p.
template <class N>
Decision folds(const Triangle& a, const Triangle& b) {
  const Vector<N> o(a.a);
  const Vector<N> along = Vector<N>(a.b) - o;
  const Vector<N> n = cross(along, Vector<N>(a.c) - o);
  const Decision in_plane = kernel::is_zero(dot(n, Vector<N>(b.c) - o));
  if (in_plane != Decision::yes) return in_plane;
  // In the plane, the normals point the same way where both lie on one side of the edge.
  return kernel::is_positive(dot(n, cross(along, Vector<N>(b.c) - o)));
}

}  // namespace

Verdict meet_beyond_corner(const Triangle& a, const Triangle& b) {
  const Triple o = kernel::triple(a.a);
  const Triple p = kernel::triple(a.b) - o;
  const Triple q = kernel::triple(a.c) - o;
  const Triple r = kernel::triple(b.b) - o;
  const Triple s = kernel::triple(b.c) - o;
  // What lies on one side of the other's plane but for the corner meets it in the corner alone.
  if (sure_side(p, q, r) * sure_side(p, q, s) > 0) return no();
  if (sure_side(r, s, p) * sure_side(r, s, q) > 0) return no();
  if (part_in_projection(a, b)) return no();
  // What they have in common is convex and has the corner in it; going away from the corner it ends on a far side.
  const Verdict first = overlaps(Triangle{a.b, a.c, a.c}, b);
  if (first.decision != Decision::no) return first;
  return overlaps(a, Triangle{b.b, b.c, b.c});
}

Verdict meet_beyond_edge(const Triangle& a, const Triangle& b) {
  const Triple o = kernel::triple(a.a);
  if (sure_side(kernel::triple(a.b) - o, kernel::triple(a.c) - o, kernel::triple(b.c) - o) != 0) return no();
  const int axis = widest_axis(a);
  const Sign one = quick_turn(a.a, a.b, a.c, (axis + 1) % 3, (axis + 2) % 3);
  const Sign other = quick_turn(a.a, a.b, b.c, (axis + 1) % 3, (axis + 2) % 3);
  if ((one == Sign::positive && other == Sign::negative) || (one == Sign::negative && other == Sign::positive))
    return no();
  return kernel::climb([&]<class N>() { return folds<N>(a, b); });
}

}  // namespace collided
