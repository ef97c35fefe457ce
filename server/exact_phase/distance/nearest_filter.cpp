#include "server/exact_phase/distance/nearest_filter.hpp"

#include <algorithm>
#include <limits>

#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine::kernel {
namespace {

/// Tests a sum of squares; NaN in any corner fails.
bool in_range(double corners2) { return corners2 >= kFilterLowest2 && corners2 <= 1 / kFilterLowest2; }

/// Weights of b and c in the triangle's point nearest to the origin, right up to rounding.
struct Weights {
  double b;
  double c;
};

/// 0 for an empty whole, as on an edge of length 0, for which any weight gives a point of the triangle.
double share(double part, double whole) { return whole > 0 ? part / whole : 0; }

Weights nearest_weights(const Triple& a, const Triple& b, const Triple& c, const Triple& ab, const Triple& ac) {
  const double d1 = -dot(ab, a);
  const double d2 = -dot(ac, a);
  if (d1 <= 0 && d2 <= 0) return {0, 0};
  const double d3 = -dot(ab, b);
  const double d4 = -dot(ac, b);
  if (d3 >= 0 && d4 <= d3) return {1, 0};
  const double d5 = -dot(ab, c);
  const double d6 = -dot(ac, c);
  if (d6 >= 0 && d5 <= d6) return {0, 1};
  const double of_c = d1 * d4 - d3 * d2;
  if (of_c <= 0 && d1 >= 0 && d3 <= 0) return {share(d1, d1 - d3), 0};
  const double of_b = d5 * d2 - d1 * d6;
  if (of_b <= 0 && d2 >= 0 && d6 <= 0) return {0, share(d2, d2 - d6)};
  const double of_a = d3 * d6 - d5 * d4;
  if (of_a <= 0 && d4 >= d3 && d5 >= d6) {
    const double along = share(d4 - d3, (d4 - d3) + (d5 - d6));
    return {1 - along, along};
  }
  const double whole = of_a + of_b + of_c;
  return {share(of_b, whole), share(of_c, whole)};
}

}  // namespace

Vec3 quick_nearest_point(const Vec3& point, const Triangle& triangle) {
  const Triple p = triple(point);
  const Triple a = triple(triangle.a) - p;
  const Triple b = triple(triangle.b) - p;
  const Triple c = triple(triangle.c) - p;
  const Weights weights = nearest_weights(a, b, c, b - a, c - a);
  return triangle.a + weights.b * (triangle.b - triangle.a) + weights.c * (triangle.c - triangle.a);
}

double quick_nearest_corner2(const Vec3& point, const Triangle& triangle) {
  const Triple p = triple(point);
  const Triple a = triple(triangle.a) - p;
  const Triple b = triple(triangle.b) - p;
  const Triple c = triple(triangle.c) - p;
  const double a2 = dot(a, a);
  const double b2 = dot(b, b);
  const double c2 = dot(c, c);
  return in_range(a2 + b2 + c2) ? std::min({a2, b2, c2}) : std::numeric_limits<double>::infinity();
}

SquareBracket quick_square_distance(const Vec3& point, const Triangle& triangle) {
  const Triple p = triple(point);
  const Triple to_a = triple(triangle.a);
  const Triple to_b = triple(triangle.b);
  const Triple to_c = triple(triangle.c);
  const Triple a = to_a - p;
  const Triple b = to_b - p;
  const Triple c = to_c - p;
  const Triple ab = to_b - to_a;
  const Triple ac = to_c - to_a;
  const double corners2 = dot(a, a) + dot(b, b) + dot(c, c);
  constexpr SquareBracket kUnknown{0, std::numeric_limits<double>::infinity()};
  if (!in_range(corners2)) return kUnknown;
  const Weights weights = nearest_weights(a, b, c, ab, ac);
  if (!(weights.b >= 0 && weights.c >= 0 && weights.b + weights.c <= 1 + 4 * kRoundoff)) return kUnknown;
  const Triple foot{(a.x + weights.b * ab.x) + weights.c * ac.x, (a.y + weights.b * ab.y) + weights.c * ac.y,
                    (a.z + weights.b * ab.z) + weights.c * ac.z};
  const double square = dot(foot, foot);
  const double error = kNearestError * corners2;
  const double before = std::min({dot(a, foot), dot(b, foot), dot(c, foot)}) - error;
  const double low2 = before > 0 ? before * before / square * (1 - 4 * kRoundoff) : 0;
  return {low2, square + error};
}

}  // namespace collided::engine::kernel
