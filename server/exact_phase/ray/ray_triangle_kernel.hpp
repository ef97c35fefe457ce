#pragma once

#include <algorithm>

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/kernels/ray_kernel.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"

namespace collided::engine::kernel {

/// Weights whose sum is 1 up to one rounding, from the first two; values slightly below zero become zero.
inline Vec3 weights_of_parts(double a, double b) {
  const double weight_a = std::clamp(a, 0.0, 1.0);
  const double weight_b = std::clamp(b, 0.0, 1.0 - weight_a);
  return {weight_a, weight_b, 1.0 - (weight_a + weight_b)};
}

/// Weights from numbers in their ratio.
inline Vec3 normalized_weights(double a, double b, double c) {
  const double sum = a + b + c;
  return weights_of_parts(a / sum, b / sum);
}

/// For corners scaled to 1: an area or product below this is mostly rounding (a few 1e-16 each, with three digits
/// left). It affects weights only.
inline constexpr double kFlat = 1e-12;

/// Barycentric weights of a point of the triangle, for a ray that gives none: it lies in the plane, or the triangle
/// spans no plane.
inline Vec3 weights_of(const Vec3& point, const Triangle& t) {
  const Vec3 corner[3] = {t.a - point, t.b - point, t.c - point};
  const double scale = std::max({corner[0].cwiseAbs().maxCoeff(), corner[1].cwiseAbs().maxCoeff(),
                                 corner[2].cwiseAbs().maxCoeff(), std::numeric_limits<double>::min()});
  const Vec3 a = corner[0] / scale;
  const Vec3 b = corner[1] / scale;
  const Vec3 c = corner[2] / scale;
  const double area[3] = {b.cross(c).norm(), c.cross(a).norm(), a.cross(b).norm()};
  const double sum = area[0] + area[1] + area[2];
  if (sum > kFlat) return normalized_weights(area[0], area[1], area[2]);
  // On an edge of a triangle without area: interpolate between the pair of corners around the point.
  const Vec3 span[3] = {a, b, c};
  Vec3 best(1, 0, 0);
  double best_length = -1;
  for (int i = 0; i < 3; ++i) {
    const Vec3& p = span[i];
    const Vec3& q = span[(i + 1) % 3];
    const double length = (q - p).norm();
    if (length <= best_length || p.dot(q) > kFlat) continue;
    best_length = length;
    best = Vec3::Zero();
    const double part = length > 0 ? std::clamp(p.norm() / length, 0.0, 1.0) : 0.0;
    best[i] = 1 - part;
    best[(i + 1) % 3] = part;
  }
  return best;
}

/// Fills a hit from the parameter on the ray.
template <class N>
void fill(const Ray& ray, const Triangle& triangle, const Facet<N>& facet, const Reach<N>& reach, RayHit& hit) {
  const Line<N> line(ray);
  const Scaled parameter = scaled(reach.numerator) / scaled(reach.denominator);
  const Bounded distance = plain(parameter * sqrt(scaled(square(line.direction))));
  hit.distance_m = distance.value;
  hit.distance_error_m = distance.bound();
  hit.exit_m = distance.value;
  hit.exit_error_m = hit.distance_error_m;
  hit.inside = false;
  for (int k = 0; k < 3; ++k) {
    hit.point[k] = ray.origin[k] + plain(parameter * scaled(Bounded(ray.direction[k]))).value;
  }
  const Vec3 direction = unit(line.direction);
  hit.normal = unit(facet.normal);
  if (hit.normal.isZero(0)) hit.normal = -direction;
  if (hit.normal.dot(direction) > 0) hit.normal = -hit.normal;
  const std::array<N, 3> side = edge_sides(line, facet);
  const Scaled sum = scaled(side[0] + side[1] + side[2]);
  if (sum.value.value == 0) {
    hit.weights = weights_of(hit.point, triangle);
  } else {
    hit.weights = normalized_weights(plain(scaled(side[1]) / sum).value, plain(scaled(side[2]) / sum).value,
                                     plain(scaled(side[0]) / sum).value);
  }
}

template <class N>
Decision meet_facet(const Ray& ray, const Facet<N>& facet, Reach<N>& reach) {
  reach = ray_to_facet(Line<N>(ray), facet);
  return reach.meets == Decision::yes ? within_length(reach, ray) : reach.meets;
}

template <class N>
Decision cast_facet(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  const Facet<N> facet(triangle);
  Reach<N> reach;
  const Decision decision = meet_facet(ray, facet, reach);
  if (decision == Decision::yes) fill(ray, triangle, facet, reach, hit);
  return decision;
}

}  // namespace collided::engine::kernel
