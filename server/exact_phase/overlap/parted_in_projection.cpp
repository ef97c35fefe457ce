#include "server/exact_phase/overlap/parted_in_projection.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

using kernel::Triple;

/// The two coordinates that remain when a triangle is seen along an axis.
struct Seen {
  int u;
  int v;
};

/// The projection along the axis on which the normal is largest, so that a triangle with area keeps area.
Seen seen_widest(const Triangle& t) {
  const Triple n = cross(kernel::triple(t.b) - kernel::triple(t.a), kernel::triple(t.c) - kernel::triple(t.a));
  const int axis =
      std::abs(n.x) > std::abs(n.y) ? (std::abs(n.x) > std::abs(n.z) ? 0 : 2) : (std::abs(n.y) > std::abs(n.z) ? 1 : 2);
  return {(axis + 1) % 3, (axis + 2) % 3};
}

/// a - b, and whether that was rounded (Knuth's sum without error).
struct RoundedDifference {
  double value;
  bool is_rounded;
};
RoundedDifference difference(double a, double b) {
  const double value = a - b;
  const double part = a - value;
  return {value, (a - (value + part)) + (part - b) != 0};
}

/// True if the rounding error of a product is a double: a factor is 0, or the product is far from both ends of the
/// range.
bool is_in_range(double product, double a, double b) {
  const double size = std::abs(product);
  return (size >= kSmallestPlain && size <= kLargestPlain) || a == 0 || b == 0;
}

int sign_of(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

/// The sign of a b - c d. Rounding preserves order, so products that round differently differ that way; else their
/// rounding errors decide.
int turn_of_products(double a, double b, double c, double d) {
  const double left = a * b;
  const double right = c * d;
  if (!is_in_range(left, a, b) || !is_in_range(right, c, d)) return kTurnUnsure;
  if (left != right) return sign_of(left - right);
  return sign_of(std::fma(a, b, -left) - std::fma(c, d, -right));
}

int rarely_sure_turn(const Vec3& o, const Vec3& p, const Vec3& q, int u, int v) {
  const RoundedDifference pu = difference(p[u], o[u]);
  const RoundedDifference pv = difference(p[v], o[v]);
  const RoundedDifference qu = difference(q[u], o[u]);
  const RoundedDifference qv = difference(q[v], o[v]);
  // Two zero factors make both products exactly zero, whatever the other factors are.
  if ((pu.value == 0 && qu.value == 0) || (pv.value == 0 && qv.value == 0)) return 0;
  if (pu.is_rounded || pv.is_rounded || qu.is_rounded || qv.is_rounded) return kTurnUnsure;
  return turn_of_products(pu.value, qv.value, pv.value, qu.value);
}

int opposite(int turn) { return turn == kTurnUnsure ? turn : -turn; }

/// True if p and q, on one line with o, lie on opposite sides of o.
bool points_away(const Vec3& o, const Vec3& p, const Vec3& q, Seen seen) {
  const int k = p[seen.u] != o[seen.u] ? seen.u : seen.v;
  return (p[k] > o[k] && q[k] < o[k]) || (p[k] < o[k] && q[k] > o[k]);
}

/// True if the line o p separates a triangle on its side `inside` from the other triangle's far corners, whose sides of
/// the line are `turns`. One of these may lie on the line if it is beyond o: then the triangles share no more of the
/// line than o.
bool parts(int inside, const Vec3& o, const Vec3& p, std::array<int, 2> turns, std::array<const Vec3*, 2> far,
           Seen seen) {
  if (inside == 0 || inside == kTurnUnsure) return false;
  int on_line = 0;
  for (std::size_t i = 0; i < 2; ++i) {
    if (turns[i] == -inside) continue;
    if (turns[i] != 0 || ++on_line > 1 || !points_away(o, p, *far[i], seen)) return false;
  }
  return true;
}

/// True if the line through one of t's sides has t on one side and the whole other triangle strictly on the other.
bool parted_by_a_side(const Triangle& t, const Triangle& other, Seen seen) {
  const std::array<const Vec3*, 3> corner{&t.a, &t.b, &t.c};
  const int inside = sure_turn(t.a, t.b, t.c, seen.u, seen.v);
  if (inside == 0 || inside == kTurnUnsure) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& from = *corner[i];
    const Vec3& to = *corner[(i + 1) % 3];
    if (sure_turn(from, to, other.a, seen.u, seen.v) == -inside &&
        sure_turn(from, to, other.b, seen.u, seen.v) == -inside &&
        sure_turn(from, to, other.c, seen.u, seen.v) == -inside) {
      return true;
    }
  }
  return false;
}

}  // namespace

int sure_turn(const Vec3& o, const Vec3& p, const Vec3& q, int u, int v) {
  const double left = (p[u] - o[u]) * (q[v] - o[v]);
  const double right = (p[v] - o[v]) * (q[u] - o[u]);
  const double turn = left - right;
  if (std::abs(turn) > kTurnError * (std::abs(left) + std::abs(right)) + std::numeric_limits<double>::min())
    return turn > 0 ? 1 : -1;
  return rarely_sure_turn(o, p, q, u, v);
}

bool parted_but_for_edge(const Triangle& a, const Triangle& b) {
  const Seen seen = seen_widest(a);
  const int of_a = sure_turn(a.a, a.b, a.c, seen.u, seen.v);
  return of_a != 0 && of_a != kTurnUnsure && sure_turn(a.a, a.b, b.c, seen.u, seen.v) == -of_a;
}

bool parted_but_for_corner(const Triangle& a, const Triangle& b) {
  const Seen seen = seen_widest(a);
  const Vec3& o = a.a;
  const auto turn = [&](const Vec3& p, const Vec3& q) { return sure_turn(o, p, q, seen.u, seen.v); };
  const int bb = turn(a.b, b.b);
  const int bc = turn(a.b, b.c);
  const int of_a = turn(a.b, a.c);
  if (parts(of_a, o, a.b, {bb, bc}, {&b.b, &b.c}, seen)) return true;
  const int cb = turn(a.c, b.b);
  const int cc = turn(a.c, b.c);
  if (parts(opposite(of_a), o, a.c, {cb, cc}, {&b.b, &b.c}, seen)) return true;
  const int of_b = turn(b.b, b.c);
  return parts(of_b, o, b.b, {opposite(bb), opposite(cb)}, {&a.b, &a.c}, seen) ||
         parts(opposite(of_b), o, b.c, {opposite(bc), opposite(cc)}, {&a.b, &a.c}, seen);
}

bool parted_in_projection(const Triangle& a, const Triangle& b) {
  const Seen seen = seen_widest(a);
  return parted_by_a_side(a, b, seen) || parted_by_a_side(b, a, seen);
}

}  // namespace collided::engine
