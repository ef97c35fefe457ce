#include "tests/oracle/wide_gap.hpp"

#include <algorithm>
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
    return to + turned(std::holds_alternative<Triangle>(part) ? own(std::get<Triangle>(part))
                                                              : std::visit(own, std::get<Primitive>(part)));
  }
  V turned(const V& v) const { return v[0] * column[0] + (v[1] * column[1] + v[2] * column[2]); }
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

/// Walks from support point to support point of the difference of two sets towards the point nearest to the origin.
class Walk {
 public:
  Walk(const PosedPart& a, const PosedPart& b) : a_(a), b_(b), simplex_{difference({1, 0, 0})}, nearest_(simplex_[0]) {}

  /// Of the points reached so far; the distance is at most this long.
  const V& nearest() const { return nearest_; }
  V difference(const V& n) const { return a_.support(n) - b_.support(Wide(-1) * n); }
  /// The farthest point towards the origin.
  V ahead() const { return difference(Wide(-1) * nearest_); }
  /// Takes the point in; true: the origin is within four of them.
  bool encloses_with(const V& w) {
    simplex_.push_back(w);
    if (surrounds_origin(simplex_)) return true;
    // Of all faces that hold their foot, the one nearest to the origin.
    std::vector<V> best;
    for (unsigned which = 1; which < 1u << simplex_.size(); ++which) {
      std::vector<V> face;
      for (std::size_t i = 0; i < simplex_.size(); ++i) {
        if (which >> i & 1) face.push_back(simplex_[i]);
      }
      V foot;
      if (face.size() > 3 || !foot_within(face, foot)) continue;
      if (!best.empty() && times(foot, foot) >= times(nearest_, nearest_)) continue;
      best = face;
      nearest_ = foot;
    }
    simplex_ = best;
    return false;
  }

 private:
  Posed a_;
  Posed b_;
  std::vector<V> simplex_;
  V nearest_;
};

constexpr int kMostSteps = 400;

}  // namespace

WideVerdict wide_verdict(const PosedPart& a, const PosedPart& b) {
  Walk walk(a, b);
  for (int step = 0; step < kMostSteps; ++step) {
    const V& v = walk.nearest();
    if (times(v, v) == 0) return WideVerdict::meet;
    const V w = walk.ahead();
    if (times(v, w) > 0) return WideVerdict::apart;
    if (walk.encloses_with(w)) return WideVerdict::meet;
    if (times(walk.nearest(), walk.nearest()) < Wide("1e-120")) return WideVerdict::unknown;
  }
  return WideVerdict::unknown;
}

WideInterval wide_distance(const PosedPart& a, const PosedPart& b, const Wide& low, const Wide& high) {
  Walk walk(a, b);
  WideInterval found{0, length(walk.nearest())};
  for (int step = 0; step < kMostSteps && found.high > 0; ++step) {
    const V w = walk.ahead();
    found.low = std::max(found.low, Wide(times(walk.nearest(), w) / length(walk.nearest())));
    const bool is_within = found.low >= low && found.high <= high;
    const bool is_outside = found.low > high || found.high < low;
    if (is_within || is_outside || walk.encloses_with(w)) break;
    found.high = length(walk.nearest());
  }
  return found;
}

Wide wide_push(const PosedPart& a, const PosedPart& b, const Vec3& n) {
  const V along = wide(n);
  const V against = Wide(-1) * along;
  return times(along, Posed(a).support(along) - Posed(b).support(against)) / length(along);
}

Wide wide_height(const PosedPart& solid, const PosedPart& half_space) {
  const Posed plane(half_space);
  const auto& own = std::get<HalfSpace>(std::get<Primitive>(half_space.part));
  const V up = plane.turned(wide(own.normal));
  const V lowest = Posed(solid).support(Wide(-1) * up);
  return times(up, lowest - plane.to - plane.turned(wide(own.point))) / length(up);
}

}  // namespace collided::oracle
