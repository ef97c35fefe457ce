#include "server/exact_phase/distance/triangle_depth.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "server/exact_phase/arithmetic/plain_range.hpp"
#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/exact_phase/distance/facet_filter.hpp"
#include "server/exact_phase/distance/nearest_filter.hpp"

namespace collided::engine::kernel {
namespace {

/// Two triangles as differences from b's first corner.
struct Differences {
  Triple a[3];
  Triple b[3];
  double size = 0;  // largest coordinate among them

  Differences(const Triangle& of_a, const Triangle& of_b) {
    const Triple origin = triple(of_b.a);
    const Vec3* const corners[2][3] = {{&of_a.a, &of_a.b, &of_a.c}, {&of_b.a, &of_b.b, &of_b.c}};
    for (int i = 0; i < 3; ++i) {
      a[i] = triple(*corners[0][i]) - origin;
      b[i] = triple(*corners[1][i]) - origin;
      size = std::max({size, a[i].largest(), b[i].largest()});
    }
  }

  /// How far b must move along n until the two only touch, and how far against it; both times |n|.
  double forward(const Triple& n) const { return largest(n, a) - smallest(n, b); }
  double backward(const Triple& n) const { return largest(n, b) - smallest(n, a); }

 private:
  static double largest(const Triple& n, const Triple (&of)[3]) {
    return std::max({dot(n, of[0]), dot(n, of[1]), dot(n, of[2])});
  }
  static double smallest(const Triple& n, const Triple (&of)[3]) {
    return std::min({dot(n, of[0]), dot(n, of[1]), dot(n, of[2])});
  }
};

/// The edges whose cross products are the facet axes of two triangles, in the order of facet_axes().
struct FacetPairs {
  static constexpr int kCount = 11;

  Differences between;
  Triple edge_a[3];
  Triple edge_b[3];

  FacetPairs(const Triangle& a, const Triangle& b) : between(a, b) {
    for (int i = 0; i < 3; ++i) {
      edge_a[i] = between.a[(i + 1) % 3] - between.a[i];
      edge_b[i] = between.b[(i + 1) % 3] - between.b[i];
    }
  }
  std::pair<Triple, Triple> edges(int i) const {
    if (i == 0) return {edge_a[0], edge_a[1]};
    if (i == 1) return {edge_b[0], edge_b[1]};
    return {edge_a[(i - 2) / 3], edge_b[(i - 2) % 3]};
  }
};

/// Error of a push along a vector taken as exact, relative to the largest coordinate of the differences: each of two
/// products is off by four roundings of |n|_1 times that, the vector's length and the quotient by a few more; 64 cover
/// both with |n|_1 <= sqrt(3) |n|.
constexpr double kPushError = 64 * kRoundoff;

}  // namespace

double gap_at_least(const Triangle& a, const Triangle& b) {
  const FacetPairs pairs(a, b);
  const Differences& between = pairs.between;
  if (!in_plain_range(between.size * between.size)) return 0;
  double least_m = 0;
  const auto try_along = [&](const Triple& n) {
    const double length2 = dot(n, n);
    if (!in_plain_range(length2)) return;
    const double gap = -std::min(between.forward(n), between.backward(n)) / std::sqrt(length2);
    least_m = std::max(least_m, gap - kPushError * between.size);
  };
  try_along(cross(pairs.edge_a[0], pairs.edge_a[1]));
  try_along(cross(pairs.edge_b[0], pairs.edge_b[1]));
  const auto sum = [](const Triple(&of)[3]) {
    return Triple{of[0].x + of[1].x + of[2].x, of[0].y + of[1].y + of[2].y, of[0].z + of[1].z + of[2].z};
  };
  try_along(sum(between.b) - sum(between.a));
  return least_m;
}

double depth_at_most(const Triangle& a, const Triangle& b, double enough_m) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const FacetPairs pairs(a, b);
  const Differences& between = pairs.between;
  if (!in_plain_range(between.size * between.size)) return kInfinity;
  double at_most_m = kInfinity;
  for (int i = 0; i < FacetPairs::kCount && !(at_most_m < enough_m); ++i) {
    const auto [u, v] = pairs.edges(i);
    const Triple n = cross(u, v);
    const double length2 = dot(n, n);
    // The push along any vector but zero separates the two, however bad the vector is as a normal.
    if (!in_plain_range(length2)) continue;
    const double push = std::min(between.forward(n), between.backward(n)) / std::sqrt(length2);
    at_most_m = std::min(at_most_m, reported_at_most(push + kPushError * between.size, 4 * between.size));
  }
  return at_most_m;
}

std::optional<Vec3> sure_normal(const Triangle& a, const Triangle& b) {
  // How flat the two edges of a normal may be, relative to the product of their largest coordinates.
  constexpr double kLeastSine = 0x1p-20;
  const FacetPairs pairs(a, b);
  double least_high = std::numeric_limits<double>::infinity();
  double least_low = least_high;
  double second_low = least_high;  // of all axes but the one with the least high
  Vec3 normal = Vec3::Zero();
  for (int i = 0; i < FacetPairs::kCount; ++i) {
    const auto [u, v] = pairs.edges(i);
    const Triple n = cross(u, v);
    const double length2 = dot(n, n);
    if (!in_plain_range(length2)) return std::nullopt;
    const double inverse = 1 / std::sqrt(length2);
    const double edges = u.largest() * v.largest();
    // Four times that of axes_of_least_push(), whose depths differ from these by less than one of its errors: axes
    // distinct here are distinct there.
    const double off = 4 * kDepthError * (2 * pairs.between.size) * edges * inverse;
    const double forward = pairs.between.forward(n) * inverse;
    const double backward = pairs.between.backward(n) * inverse;
    const double depth = std::min(forward, backward);
    if (!(depth + off < least_high)) {
      second_low = std::min(second_low, depth - off);
      continue;
    }
    second_low = std::min(second_low, least_low);
    least_high = depth + off;
    least_low = depth - off;
    // Flat edges leave the normal's direction open, nearly equal pushes its sign.
    const bool is_known = inverse * (kLeastSine * edges) < 1 && std::abs(forward - backward) > 2 * off;
    const double sign = !is_known ? 0 : backward < forward ? -inverse : inverse;
    normal = Vec3(sign * n.x, sign * n.y, sign * n.z);
  }
  if (!(least_high < second_low) || normal.isZero(0)) return std::nullopt;
  return normal;
}

}  // namespace collided::engine::kernel
