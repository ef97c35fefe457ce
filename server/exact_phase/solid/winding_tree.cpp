#include "server/exact_phase/solid/winding_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "server/exact_phase/arithmetic/number.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

using BoundedPoint = kernel::Vector<Bounded>;

// Fewer triangles are summed one by one: a cluster costs about as much as one of them, and must be far away.
constexpr std::uint32_t kFewTriangles = 6;
// A sum of n non-negative doubles is off by at most n roundings; includes the rounding of its terms.
double grown_sum(double sum, std::size_t n) { return sum * (1 + static_cast<double>(2 * n + 64) * kRoundoff); }

/// The angle of a point in the plane with bounded coordinates; anywhere on the circle if the point may be the origin,
/// or on both sides of the negative axis.
Bounded angle_of(const Bounded& y, const Bounded& x) {
  const double reach = std::hypot(x.value, y.value) * (1 - 4 * kRoundoff);
  const double off = std::hypot(x.bound(), y.bound()) * (1 + 4 * kRoundoff);
  const bool is_across = x.value < x.bound() && std::abs(y.value) <= y.bound();
  if (!(off < reach) || is_across) return {0, std::numbers::pi * (1 + 4 * kRoundoff)};
  // The disc of that radius is seen under an angle whose sine is the quotient, and asin(s) <= s pi / 2.
  const double angle = std::atan2(y.value, x.value);
  return {angle, (off / reach * (std::numbers::pi / 2) + 4 * kRoundoff * std::abs(angle)) * (1 + kBoundSlack)};
}

/// Half the solid angle of a triangle, positive from behind. Source: Van Oosterom, Strackee, "The solid angle of a
/// plane triangle", IEEE Transactions on Biomedical Engineering 30, 1983.
Bounded half_solid_angle(const Triangle& t, const BoundedPoint& point) {
  const BoundedPoint a = BoundedPoint(t.a) - point;
  const BoundedPoint b = BoundedPoint(t.b) - point;
  const BoundedPoint c = BoundedPoint(t.c) - point;
  const Bounded length_a = sqrt(dot(a, a));
  const Bounded length_b = sqrt(dot(b, b));
  const Bounded length_c = sqrt(dot(c, c));
  const Bounded x = length_a * length_b * length_c + dot(a, b) * length_c + dot(b, c) * length_a + dot(c, a) * length_b;
  return angle_of(dot(a, cross(b, c)), x);
}

Vec3 middle_of(const Triangle& t) { return t.a / 3 + t.b / 3 + t.c / 3; }

Triangle scaled(const Triangle& t, int exponent) {
  const auto by = [&](const Vec3& v) { return Vec3(v.unaryExpr([&](double x) { return std::ldexp(x, exponent); })); };
  return {by(t.a), by(t.b), by(t.c)};
}

}  // namespace

WindingTree::WindingTree(const TriangleMesh& mesh) {
  for (const TriangleCorners& corners : mesh.triangles) {
    for (const std::uint32_t corner : corners) bounds_.extend(mesh.vertices[corner]);
  }
  if (mesh.triangles.empty()) return;
  const double reach = std::max(bounds_.low.cwiseAbs().maxCoeff(), bounds_.high.cwiseAbs().maxCoeff());
  if (reach > 0) exponent_ = -std::ilogb(reach);
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) triangles_.push_back(scaled(mesh.triangle(i), exponent_));
  clusters_.reserve(triangles_.size() / 2);
  divide(0, static_cast<std::uint32_t>(triangles_.size()));
}

std::uint32_t WindingTree::divide(std::uint32_t first, std::uint32_t count) {
  const auto number = static_cast<std::uint32_t>(clusters_.size());
  clusters_.push_back(cluster_of(first, count));
  if (count <= kFewTriangles) return number;
  Aabb middles;
  for (std::uint32_t i = 0; i < count; ++i) middles.extend(middle_of(triangles_[first + i]));
  int axis = 0;
  (middles.high - middles.low).maxCoeff(&axis);
  const auto begin = triangles_.begin() + first;
  const std::uint32_t half = count / 2;
  std::nth_element(begin, begin + half, begin + count,
                   [axis](const Triangle& s, const Triangle& t) { return middle_of(s)[axis] < middle_of(t)[axis]; });
  divide(first, half);
  const std::uint32_t other = divide(first + half, count - half);
  clusters_[number].other = other;
  return number;
}

WindingTree::WindingCluster WindingTree::cluster_of(std::uint32_t first, std::uint32_t count) const {
  WindingCluster cluster;
  cluster.first = first;
  cluster.count = count;
  double weight = 0;
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Triangle& t = triangles_[i];
    const double area = (t.b - t.a).cross(t.c - t.a).norm();
    cluster.centre += area * middle_of(t);
    weight += area;
  }
  cluster.centre = weight > 0 ? Vec3(cluster.centre / weight) : middle_of(triangles_[first]);
  const BoundedPoint centre(cluster.centre);
  Bounded normal[3];
  Bounded moment[3][3];
  for (std::uint32_t i = first; i < first + count; ++i) {
    const Triangle& t = triangles_[i];
    const BoundedPoint a = BoundedPoint(t.a) - centre;
    const BoundedPoint b = BoundedPoint(t.b) - centre;
    const BoundedPoint c = BoundedPoint(t.c) - centre;
    const BoundedPoint half =
        Bounded(0.5) * cross(BoundedPoint(t.b) - BoundedPoint(t.a), BoundedPoint(t.c) - BoundedPoint(t.a));
    const BoundedPoint middle = Bounded(1.0) / Bounded(3.0) * (a + b + c);
    const Bounded n[3] = {half.x, half.y, half.z};
    const Bounded g[3] = {middle.x, middle.y, middle.z};
    for (int row = 0; row < 3; ++row) {
      normal[row] = normal[row] + n[row];
      for (int column = 0; column < 3; ++column) moment[row][column] = moment[row][column] + n[row] * g[column];
    }
    const double area = sqrt(dot(half, half)).high();
    const double far2 = std::max({dot(a, a).high(), dot(b, b).high(), dot(c, c).high()});
    cluster.area += area;
    cluster.spread += area * far2;
    cluster.radius = std::max(cluster.radius, std::sqrt(far2) * (1 + 4 * kRoundoff));
  }
  cluster.area = grown_sum(cluster.area, count);
  cluster.spread = grown_sum(cluster.spread, count) + kUnderflow;
  for (int row = 0; row < 3; ++row) {
    cluster.normal[row] = normal[row].value;
    cluster.normal_error += normal[row].bound();
    for (int column = 0; column < 3; ++column) {
      cluster.moment(row, column) = moment[row][column].value;
      cluster.moment_error += moment[row][column].bound();
    }
  }
  cluster.normal_error = grown_sum(cluster.normal_error, 3);
  cluster.moment_error = grown_sum(cluster.moment_error, 9);
  return cluster;
}

/// Half the solid angle of all its triangles together.
///
/// moved  bound on the distance between the point and the origin of `to_centre`
/// near   lower bound on the distance of the true point from the centre, and more than twice the radius
Bounded WindingTree::half_solid_angle_from_afar(const WindingCluster& c, const Vec3& to_centre, double moved,
                                                double near) {
  const double d = to_centre.norm();
  const double q = c.radius / near;
  const double near2 = near * near;
  const double near3 = near2 * near;
  const double value = c.normal.dot(to_centre) / (d * d * d) + c.moment.trace() / (d * d * d) -
                       3 * to_centre.dot(c.moment * to_centre) / (d * d * d * d * d);
  // The n-th derivatives of 1 / |x| are at most n! / |x|^(n + 1): in the Taylor series from the cluster's centre the
  // terms from the third on are at most (k + 1) |x - centre|^k / d^(k + 2), k = 2, 3, ...
  const double left_out = c.spread * (3 - 2 * q) / ((1 - q) * (1 - q)) / (near2 * near2);
  const double shift = 2 * c.area * moved / (near3 * (1 - q) * (1 - q) * (1 - q));
  const double coefficients = c.normal_error / near2 + 4 * c.moment_error / near3;
  const double rounded =
      64 * kRoundoff * (c.normal.lpNorm<1>() / near2 + 4 * c.moment.cwiseAbs().sum() / near3) + 8 * kUnderflow;
  return {value / 2, (left_out + shift + coefficients + rounded) / 2 * (1 + 64 * kRoundoff)};
}

Bounded WindingTree::around(const Vec3& given, double off_m, double widest, std::uint32_t& nodes) const {
  if (clusters_.empty()) return {};
  const Vec3 point = given.unaryExpr([&](double x) { return std::ldexp(x, exponent_); });
  // Scaling rounds numbers that become subnormal.
  const double off = std::ldexp(off_m, exponent_) + kUnderflow;
  if (!point.allFinite() || !std::isfinite(off)) return {0, std::numeric_limits<double>::infinity()};
  const BoundedPoint exact(Bounded(point.x(), off), Bounded(point.y(), off), Bounded(point.z(), off));
  Bounded sum;
  constexpr std::size_t kMostWaiting = 64;  // halves of halves of fewer than 2^32 triangles
  std::array<std::uint32_t, kMostWaiting> waiting;
  std::size_t waiting_count = 0;
  std::uint32_t at = 0;
  while (true) {
    const WindingCluster& c = clusters_[at];
    ++nodes;
    const Vec3 to_centre = c.centre - point;
    const double distance = to_centre.norm();
    // The difference is rounded, which has the effect of a moved point.
    const double moved = (2 * off + 8 * kRoundoff * distance) * (1 + kBoundSlack);
    const double near = (distance - moved) * (1 - 8 * kRoundoff);
    if (near > 0 && c.radius <= widest * near) {
      sum = sum + half_solid_angle_from_afar(c, to_centre, moved, near);
    } else if (c.other != 0) {
      waiting[waiting_count++] = c.other;
      ++at;
      continue;
    } else {
      for (std::uint32_t i = c.first; i < c.first + c.count; ++i) sum = sum + half_solid_angle(triangles_[i], exact);
      nodes += c.count;
    }
    if (waiting_count == 0) break;
    at = waiting[--waiting_count];
  }
  constexpr double kTurn = 2 * std::numbers::pi;
  return Bounded(sum.value, grown_sum(sum.error, nodes)) / Bounded(kTurn, kTurn * kRoundoff);
}

WindingSide WindingTree::side_of(const Bounded& number, const Vec3& point, double off_m) const {
  const double beyond_m = std::max((bounds_.low - point).maxCoeff(), (point - bounds_.high).maxCoeff());
  if (beyond_m > off_m * (1 + kBoundSlack) || number.high() <= 0.5) return WindingSide::out;
  return number.low() > 0.5 && beyond_m <= -off_m * (1 + kBoundSlack) ? WindingSide::in : WindingSide::undecided;
}

WindingSide WindingTree::side(const Vec3& point, double off_m, std::uint32_t& nodes) const {
  // The number is not known yet; the bounds alone may decide.
  if (side_of({0, std::numeric_limits<double>::infinity()}, point, off_m) == WindingSide::out) return WindingSide::out;
  // On a closed surface the coarsest decides all points but those close to it; near a hole finer ones are needed.
  for (const double widest : {0.35, 0.12, 0.04, 0.01}) {
    const WindingSide found = side_of(around(point, off_m, widest, nodes), point, off_m);
    if (found != WindingSide::undecided) return found;
  }
  return WindingSide::undecided;
}

WindingSide WindingTree::side_by_sum(const Vec3& point, double off_m) const {
  std::uint32_t nodes = 0;
  return side_of(around(point, off_m, 0, nodes), point, off_m);
}

}  // namespace collided::engine
