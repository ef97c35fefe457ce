#include "tests/oracle/wide_gap.hpp"

#include <array>
#include <vector>

#include "server/geometry/mesh.hpp"

namespace collided::oracle {
namespace {

using V = std::array<Wide, 3>;

V wide(const Vec3& v) { return {Wide(v[0]), Wide(v[1]), Wide(v[2])}; }
V operator+(const V& a, const V& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
V operator-(const V& a, const V& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
V operator*(const Wide& s, const V& v) { return {s * v[0], s * v[1], s * v[2]}; }
Wide times(const V& a, const V& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
V across(const V& a, const V& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Wide length(const V& v) { return sqrt(times(v, v)); }
V unit(const V& v) { return (1 / length(v)) * v; }

/// Columns of the rotation.
std::array<V, 3> rotation_of(const Quat& q) {
  const Wide w(q.w()), x(q.x()), y(q.y()), z(q.z());
  const Wide s = 2 / (w * w + x * x + y * y + z * z);
  return {V{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
          V{s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
          V{s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}};
}

template <class Points>
V farthest(const Points& points, const V& n) {
  V best = wide(*points.begin());
  for (const Vec3& point : points) {
    if (times(wide(point), n) > times(best, n)) best = wide(point);
  }
  return best;
}

V disc_point(const V& center, const V& axis, double radius_m, const V& n) {
  const V along = n - (times(n, axis) / times(axis, axis)) * axis;
  // Along the axis to some 40 digits: the whole disc is as far, and what is left of n is rounding.
  if (times(along, along) <= Wide("1e-80") * times(n, n)) return center;
  return center + Wide(radius_m) * unit(along);
}

/// The farthest point of a shape along n, in its own frame.
struct Support {
  V n;

  V operator()(const Sphere& s) const { return wide(s.center) + Wide(s.radius_m) * unit(n); }
  V operator()(const Capsule& c) const { return farthest(std::array{c.a, c.b}, n) + Wide(c.radius_m) * unit(n); }
  V operator()(const Triangle& t) const { return farthest(std::array{t.a, t.b, t.c}, n); }
  V operator()(const Hull& h) const { return farthest(h.mesh->vertices, n); }
  V operator()(const Box& b) const {
    V point = wide(b.center);
    for (int i = 0; i < 3; ++i) {
      const V axis = wide(b.axes.col(i));
      point = point + (times(axis, n) < 0 ? Wide(-b.half_m[i]) : Wide(b.half_m[i])) * axis;
    }
    return point;
  }
  V operator()(const Cylinder& c) const {
    const V axis = wide(c.b) - wide(c.a);
    return disc_point(times(axis, n) > 0 ? wide(c.b) : wide(c.a), axis, c.radius_m, n);
  }
  V operator()(const Cone& c) const {
    const V rim = disc_point(wide(c.base), wide(c.base) - wide(c.apex), c.radius_m, n);
    return times(rim, n) > times(wide(c.apex), n) ? rim : wide(c.apex);
  }
  V operator()(const Ellipsoid& e) const {
    V along{};
    for (int i = 0; i < 3; ++i) along[i] = Wide(e.half_m[i]) * times(wide(e.axes.col(i)), n);
    const Wide reach = length(along);
    V point = wide(e.center);
    for (int i = 0; i < 3; ++i) point = point + (along[i] / reach * Wide(e.half_m[i])) * wide(e.axes.col(i));
    return point;
  }
  V operator()(const HalfSpace& h) const { return wide(h.point); }
};

struct Posed {
  const ConvexPart& part;
  std::array<V, 3> column;
  V to;

  explicit Posed(const PosedPart& p) : part(p.part), column(rotation_of(p.pose.rotation)), to(wide(p.pose.position)) {}

  V support(const V& n) const {
    const Support own{{times(column[0], n), times(column[1], n), times(column[2], n)}};
    const V point = std::holds_alternative<Triangle>(part) ? own(std::get<Triangle>(part))
                                                           : std::visit(own, std::get<Primitive>(part));
    return to + (point[0] * column[0] + (point[1] * column[1] + point[2] * column[2]));
  }
};

/// The point nearest to the origin of the flat through some points, if it is among them.
bool foot_within(const std::vector<V>& points, V& foot) {
  if (points.size() == 1) {
    foot = points[0];
    return true;
  }
  // Projects the first point away from directions made orthogonal one by one; weights by back substitution.
  const std::size_t count = points.size() - 1;
  std::vector<std::vector<Wide>> gram(count, std::vector<Wide>(count + 1));
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) gram[i][j] = times(points[i + 1] - points[0], points[j + 1] - points[0]);
    gram[i][count] = -times(points[i + 1] - points[0], points[0]);
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (gram[i][i] <= 0) return false;
    for (std::size_t k = 0; k < count; ++k) {
      if (k == i) continue;
      const Wide share = gram[k][i] / gram[i][i];
      for (std::size_t j = i; j <= count; ++j) gram[k][j] -= share * gram[i][j];
    }
  }
  foot = points[0];
  Wide first = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const Wide weight = gram[i][count] / gram[i][i];
    if (weight < 0) return false;
    first -= weight;
    foot = foot + weight * (points[i + 1] - points[0]);
  }
  return first >= 0;
}

Wide volume(const V& a, const V& b, const V& c) { return times(a, across(b, c)); }

/// Whether the origin is on the inner side of all four faces, by far more than these digits round.
bool surrounds_origin(const std::vector<V>& p) {
  if (p.size() != 4) return false;
  const Wide least("1e-80");
  const Wide all = times(p[3] - p[0], across(p[1] - p[0], p[2] - p[0]));
  const Wide turn = all < 0 ? -1 : 1;
  return turn * volume(p[1], p[2], p[3]) > least && -turn * volume(p[0], p[2], p[3]) > least &&
         turn * volume(p[0], p[1], p[3]) > least && -turn * volume(p[0], p[1], p[2]) > least;
}

}  // namespace

WideVerdict wide_verdict(const PosedPart& a, const PosedPart& b) {
  const Posed of_a(a);
  const Posed of_b(b);
  const auto difference = [&](const V& n) { return of_a.support(n) - of_b.support(Wide(-1) * n); };
  std::vector<V> simplex{difference({1, 0, 0})};
  V v = simplex[0];
  for (int step = 0; step < 400; ++step) {
    if (times(v, v) == 0) return WideVerdict::meet;
    const V w = difference(Wide(-1) * v);
    if (times(v, w) > 0) return WideVerdict::apart;
    simplex.push_back(w);
    if (surrounds_origin(simplex)) return WideVerdict::meet;
    // Of all faces that hold their foot, the one nearest to the origin.
    std::vector<V> best;
    for (unsigned which = 1; which < 1u << simplex.size(); ++which) {
      std::vector<V> face;
      for (std::size_t i = 0; i < simplex.size(); ++i) {
        if (which >> i & 1) face.push_back(simplex[i]);
      }
      V foot;
      if (face.size() > 3 || !foot_within(face, foot)) continue;
      if (!best.empty() && times(foot, foot) >= times(v, v)) continue;
      best = face;
      v = foot;
    }
    simplex = best;
    if (times(v, v) < Wide("1e-120")) return WideVerdict::unknown;
  }
  return WideVerdict::unknown;
}

}  // namespace collided::oracle
