#include "tests/oracle/solid_oracle.hpp"

#include <cmath>
#include <optional>

namespace collided::oracle {
namespace {

using Integers = std::array<mpz_class, 3>;

Integers operator-(const Integers& a, const Integers& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Integers cross(const Integers& a, const Integers& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
mpz_class dot(const Integers& a, const Integers& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
bool is_zero(const Integers& a) { return a[0] == 0 && a[1] == 0 && a[2] == 0; }

/// Whether the segment holds the origin.
bool holds_origin(const Integers& a, const Integers& b) { return is_zero(cross(a, b)) && dot(a, b) <= 0; }

/// Whether the closed triangle a b c holds the origin.
bool holds_origin(const Integers& a, const Integers& b, const Integers& c) {
  const Integers normal = cross(b - a, c - a);
  if (is_zero(normal)) return holds_origin(a, b) || holds_origin(b, c) || holds_origin(c, a);
  return dot(normal, a) == 0 && dot(normal, cross(a, b)) >= 0 && dot(normal, cross(b, c)) >= 0 &&
         dot(normal, cross(c, a)) >= 0;
}

/// 1 where the ray from the origin leaves through the triangle, -1 where it enters, 0 where it passes; nothing where it
/// meets an edge or runs within the triangle's plane.
std::optional<int> step(const Integers& a, const Integers& b, const Integers& c, const Integers& direction) {
  const int turns[] = {sgn(dot(direction, cross(a, b))), sgn(dot(direction, cross(b, c))),
                       sgn(dot(direction, cross(c, a)))};
  const bool some_left = turns[0] > 0 || turns[1] > 0 || turns[2] > 0;
  const bool some_right = turns[0] < 0 || turns[1] < 0 || turns[2] < 0;
  if (some_left && some_right) return 0;
  if (turns[0] * turns[1] * turns[2] == 0) return std::nullopt;
  const int way = some_left ? 1 : -1;
  return sgn(dot(a, cross(b, c))) == way ? way : 0;
}

}  // namespace

RationalPoint rational(const Vec3& point) { return {mpq_class(point[0]), mpq_class(point[1]), mpq_class(point[2])}; }

RationalPoint seen_from(const Pose& pose, const Vec3& point) {
  const mpq_class w(pose.rotation.w());
  const RationalPoint v = rational(Vec3(-pose.rotation.vec()));
  RationalPoint p = rational(point);
  for (int i = 0; i < 3; ++i) p[i] -= mpq_class(pose.position[i]);
  const mpq_class along = v[0] * p[0] + v[1] * p[1] + v[2] * p[2];
  const mpq_class square = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
  RationalPoint seen;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const mpq_class turned = v[j] * p[k] - v[k] * p[j];
    seen[i] = ((w * w - square) * p[i] + 2 * along * v[i] + 2 * w * turned) / (w * w + square);
  }
  return seen;
}

SolidOracle::SolidOracle(const TriangleMesh& mesh) : triangles_(mesh.triangles) {
  for (const Vec3& vertex : mesh.vertices) {
    for (const mpq_class& x : rational(vertex)) {
      shift_ = std::max(shift_, static_cast<unsigned long>(mpz_sizeinbase(x.get_den_mpz_t(), 2) - 1));
    }
  }
  for (const Vec3& vertex : mesh.vertices) {
    Integers scaled;
    for (int i = 0; i < 3; ++i) {
      mpq_class x(vertex[i]);
      mpq_mul_2exp(x.get_mpq_t(), x.get_mpq_t(), shift_);
      scaled[i] = x.get_num();
    }
    vertices_.push_back(scaled);
  }
}

SolidSide SolidOracle::side(const RationalPoint& point, std::mt19937_64& random) const {
  mpz_class factor = 1;
  for (const mpq_class& x : point) factor = lcm(factor, x.get_den());
  Integers at;
  for (int i = 0; i < 3; ++i) {
    at[i] = point[i].get_num() * (factor / point[i].get_den());
    mpz_mul_2exp(at[i].get_mpz_t(), at[i].get_mpz_t(), shift_);
  }
  std::vector<Integers> seen;
  for (const Integers& vertex : vertices_)
    seen.push_back({vertex[0] * factor - at[0], vertex[1] * factor - at[1], vertex[2] * factor - at[2]});
  for (const TriangleCorners& t : triangles_) {
    if (holds_origin(seen[t[0]], seen[t[1]], seen[t[2]])) return SolidSide::on;
  }
  std::uniform_int_distribution<long> any(-1'000'000, 1'000'000);
  while (true) {
    const Integers direction{any(random), any(random), any(random)};
    int around = 0;
    bool is_clear = !is_zero(direction);
    for (std::size_t i = 0; i < triangles_.size() && is_clear; ++i) {
      const TriangleCorners& t = triangles_[i];
      const bool is_flat = is_zero(cross(seen[t[1]] - seen[t[0]], seen[t[2]] - seen[t[0]]));
      const std::optional<int> found = is_flat ? 0 : step(seen[t[0]], seen[t[1]], seen[t[2]], direction);
      is_clear = found.has_value();
      around += found.value_or(0);
    }
    if (is_clear) return around > 0 ? SolidSide::in : SolidSide::out;
  }
}

}  // namespace collided::oracle
