#include "server/exact_phase/overlap/neighbours.hpp"

#include "server/exact_phase/arithmetic/number.hpp"
#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/overlap/parted_in_projection.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

using kernel::Triple;
using kernel::Vector;

/// The side of the plane through o, p, q on which r lies, if plain double is certain, else 0; arguments are relative to
/// o.
int sure_side(const Triple& p, const Triple& q, const Triple& r) {
  const double product = dot(r, cross(p, q));
  const double scale = p.largest() * q.largest() * r.largest();
  // Below, products of differences might underflow; above, overflow.
  constexpr double kSmallestScale = 0x1p-300;  // its square does not underflow, nor a product of the two
  // Below this range products of differences may underflow, above it they may overflow.
  if (!(scale >= kSmallestScale && scale <= kLargestPlain)) return 0;
  const double error = kOrientationError * scale;
  return product > error ? 1 : product < -error ? -1 : 0;
}

ExactResult no() { return {Decision::no, Level::filter}; }

/// True if the four points lie in one plane, with a and b on the same side of their common edge.
template <class N>
Decision folds(const Triangle& a, const Triangle& b) {
  const Vector<N> o(a.a);
  const Vector<N> along = Vector<N>(a.b) - o;
  const Vector<N> n = cross(along, Vector<N>(a.c) - o);
  const Decision in_plane = kernel::is_zero(dot(n, Vector<N>(b.c) - o));
  if (in_plane != Decision::yes) return in_plane;
  // In the plane, the two normals agree if both triangles lie on one side of the edge.
  return kernel::is_positive(dot(n, cross(along, Vector<N>(b.c) - o)));
}

}  // namespace

ExactResult meet_beyond_corner(const Triangle& a, const Triangle& b) {
  const Triple o = kernel::triple(a.a);
  const Triple p = kernel::triple(a.b) - o;
  const Triple q = kernel::triple(a.c) - o;
  const Triple r = kernel::triple(b.b) - o;
  const Triple s = kernel::triple(b.c) - o;
  // A triangle that lies on one side of the other's plane except for the corner meets it in the corner alone.
  if (sure_side(p, q, r) * sure_side(p, q, s) > 0) return no();
  if (sure_side(r, s, p) * sure_side(r, s, q) > 0) return no();
  if (parted_but_for_corner(a, b)) return no();
  // Their common part is convex and contains the corner; away from the corner, it ends on a far side of one of them.
  const ExactResult first = overlaps(Triangle{a.b, a.c, a.c}, b);
  if (first.decision != Decision::no) return first;
  return overlaps(a, Triangle{b.b, b.c, b.c});
}

ExactResult meet_beyond_edge(const Triangle& a, const Triangle& b) {
  const Triple o = kernel::triple(a.a);
  if (sure_side(kernel::triple(a.b) - o, kernel::triple(a.c) - o, kernel::triple(b.c) - o) != 0) return no();
  if (parted_but_for_edge(a, b)) return no();
  return kernel::climb([&]<class N>() { return folds<N>(a, b); });
}

}  // namespace collided::engine
