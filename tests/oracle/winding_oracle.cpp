#include "tests/oracle/winding_oracle.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace collided::oracle {
namespace {

using LongVector = std::array<long double, 3>;

LongVector difference(const Vec3& a, const Vec3& b) {
  return {static_cast<long double>(a[0]) - b[0], static_cast<long double>(a[1]) - b[1],
          static_cast<long double>(a[2]) - b[2]};
}
long double dot(const LongVector& a, const LongVector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
LongVector cross(const LongVector& a, const LongVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

long double winding_by_sum(const TriangleMesh& mesh, const Vec3& point) {
  long double half_angles = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle t = mesh.triangle(i);
    const LongVector a = difference(t.a, point);
    const LongVector b = difference(t.b, point);
    const LongVector c = difference(t.c, point);
    const long double to_a = std::sqrt(dot(a, a));
    const long double to_b = std::sqrt(dot(b, b));
    const long double to_c = std::sqrt(dot(c, c));
    half_angles +=
        std::atan2(dot(a, cross(b, c)), to_a * to_b * to_c + dot(a, b) * to_c + dot(b, c) * to_a + dot(c, a) * to_b);
  }
  return half_angles / (2 * std::numbers::pi_v<long double>);
}

}  // namespace collided::oracle
