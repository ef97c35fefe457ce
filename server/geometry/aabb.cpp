#include "server/geometry/aabb.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "server/geometry/lost_in_sum.hpp"
#include "server/geometry/mesh.hpp"
#include "server/geometry/pose.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// std::nextafter(x, infinity) for finite x, without the call: bounds of every mover are computed in every step.
double next_up(double x) {
  if (x == 0) return std::numeric_limits<double>::denorm_min();
  const auto bits = std::bit_cast<std::int64_t>(x);
  return std::bit_cast<double>(bits + (x > 0 ? 1 : -1));
}

/// The smallest double >= a + b. Exact sums stay as they are, so that touching boxes keep touching bounds. Without a
/// branch on the lost part, which is unpredictable. A sum of zero has lost nothing.
double sum_up(double a, double b) {
  const double sum = a + b;
  const auto bits = std::bit_cast<std::int64_t>(sum);
  const std::int64_t one_up = bits >> 63 | 1;
  const std::int64_t has_lost = lost_in_sum(a, b, sum) > 0 ? -1 : 0;
  const double up = std::bit_cast<double>(bits + (one_up & has_lost));
  return sum == -kInfinity ? std::numeric_limits<double>::lowest() : up;
}

double sum_down(double a, double b) { return -sum_up(-a, -b); }

/// A double >= a * b, for a, b >= 0. The low half of a product below 2^-960 may be lost, so such a product is always
/// stepped up.
double product_up(double a, double b) {
  if (a == 0 || b == 0) return 0;
  const double product = a * b;
  const bool exact = product > kSmallestExactProduct && std::fma(a, b, -product) <= 0;
  return exact || product == kInfinity ? product : next_up(product);
}

/// The box center +- reach, rounded outward.
Aabb around(const Vec3& center, const Vec3& reach) {
  Aabb box;
  for (int k = 0; k < 3; ++k) {
    box.low[k] = sum_down(center[k], -reach[k]);
    box.high[k] = sum_up(center[k], reach[k]);
  }
  return box;
}

}  // namespace

Aabb bounds(const Sphere& sphere) { return around(sphere.center, Vec3::Constant(sphere.radius_m)); }

Aabb bounds(const Box& box) {
  Vec3 reach;
  for (int k = 0; k < 3; ++k) {
    reach[k] = 0;
    for (int i = 0; i < 3; ++i) reach[k] = sum_up(reach[k], product_up(std::abs(box.axes(k, i)), box.half_m[i]));
  }
  return around(box.center, reach);
}

Aabb bounds(const Capsule& capsule) {
  Aabb box = around(capsule.a, Vec3::Constant(capsule.radius_m));
  box.extend(around(capsule.b, Vec3::Constant(capsule.radius_m)));
  return box;
}

namespace {

/// The root of a sum of squares, with ten roundings and underflow added outward.
double root_up(double squares) {
  constexpr double kRootOfUnderflow = 0x1p-500;
  return std::sqrt(squares) * (1 + kChainSlack) + kRootOfUnderflow;
}

/// The reach of a disc of that radius, perpendicular to a b, along each axis.
Vec3 disc_reach(const Vec3& a, const Vec3& b, double radius_m) {
  const Vec3 axis = b - a;
  // Scaled by the largest component, so that no square overflows.
  const Vec3 d = axis / axis.cwiseAbs().maxCoeff();
  const double length2 = d.squaredNorm();
  Vec3 reach;
  for (int k = 0; k < 3; ++k) {
    const double rest2 = d[(k + 1) % 3] * d[(k + 1) % 3] + d[(k + 2) % 3] * d[(k + 2) % 3];
    reach[k] = product_up(radius_m, std::min(1.0, root_up(rest2 / length2)));
  }
  return reach;
}

}  // namespace

Aabb bounds(const Cylinder& cylinder) {
  const Vec3 reach = disc_reach(cylinder.a, cylinder.b, cylinder.radius_m);
  Aabb box = around(cylinder.a, reach);
  box.extend(around(cylinder.b, reach));
  return box;
}

Aabb bounds(const Cone& cone) {
  Aabb box = around(cone.base, disc_reach(cone.apex, cone.base, cone.radius_m));
  box.extend(cone.apex);
  return box;
}

Aabb bounds(const Ellipsoid& ellipsoid) {
  const double largest = ellipsoid.half_m.maxCoeff();
  if (largest == 0) return around(ellipsoid.center, Vec3::Zero());
  Vec3 reach;
  for (int k = 0; k < 3; ++k) {
    double squares = 0;
    for (int i = 0; i < 3; ++i) {
      const double part = ellipsoid.axes(k, i) * (ellipsoid.half_m[i] / largest);
      squares += part * part;
    }
    reach[k] = product_up(largest, root_up(squares));
  }
  return around(ellipsoid.center, reach);
}

Aabb bounds(const Hull& hull) {
  Aabb box;
  for (std::size_t i = 0; i < hull.mesh->vertices.size(); ++i) box.extend(vertex_of(hull, i));
  return box;
}

Aabb bounds(const HalfSpace& half_space) {
  Aabb box{.low = Vec3::Constant(-kInfinity), .high = Vec3::Constant(kInfinity)};
  const Vec3& n = half_space.normal;
  for (int k = 0; k < 3; ++k) {
    if (n[(k + 1) % 3] != 0 || n[(k + 2) % 3] != 0) continue;
    if (n[k] > 0) box.high[k] = half_space.point[k];
    if (n[k] < 0) box.low[k] = half_space.point[k];
  }
  return box;
}

Aabb bounds_within(const HalfSpace& half_space, const Aabb& box) {
  Aabb rest = box;
  // Along each axis, as far as the box allows on the others: n_k (x_k - p_k) <= sum of -n_j (x_j - p_j).
  Vec3 room;
  for (int k = 0; k < 3; ++k) {
    const double n = half_space.normal[k];
    const double nearest = n > 0 ? box.low[k] : box.high[k];
    // Covers the two roundings of difference and product, upward.
    room[k] = n == 0 ? 0 : -n * (nearest - half_space.point[k]);
    room[k] += 4 * kRoundoff * std::abs(n) * (std::abs(nearest) + std::abs(half_space.point[k])) + kUnderflow;
  }
  for (int k = 0; k < 3; ++k) {
    const double n = half_space.normal[k];
    const double others = room[(k + 1) % 3] + room[(k + 2) % 3];
    if (n == 0) continue;
    const double reach = others / std::abs(n);
    const double slack = 8 * kRoundoff * (std::abs(reach) + std::abs(half_space.point[k])) + kUnderflow;
    if (!std::isfinite(reach + slack)) continue;
    if (n > 0) rest.high[k] = std::min(rest.high[k], half_space.point[k] + reach + slack);
    else rest.low[k] = std::max(rest.low[k], half_space.point[k] - reach - slack);
  }
  return rest;
}

Aabb bounds(const Triangle& triangle) {
  Aabb box;
  box.extend(triangle.a);
  box.extend(triangle.b);
  box.extend(triangle.c);
  return box;
}

Aabb bounds(const Primitive& primitive) {
  return std::visit([](const auto& shape) { return bounds(shape); }, primitive);
}

Aabb grown(const Aabb& box, double margin_m) {
  if (box.empty()) return box;
  Aabb result;
  for (int k = 0; k < 3; ++k) {
    result.low[k] = sum_down(box.low[k], -margin_m);
    result.high[k] = sum_up(box.high[k], margin_m);
  }
  return result;
}

}  // namespace collided::engine
