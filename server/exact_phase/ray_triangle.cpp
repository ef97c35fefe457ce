#include <algorithm>

#include "server/exact_phase/ray_cast.hpp"
#include "server/exact_phase/ray_kernel.hpp"
#include "server/exact_phase/triple.hpp"
#include "server/exact_phase/value.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided {
namespace {

using namespace kernel;

/// Weights whose sum is 1 to one rounding; a hair below zero becomes zero.
Vec3 normalized_weights(double a, double b, double c) {
  const double sum = a + b + c;
  const double weight_a = std::clamp(a / sum, 0.0, 1.0);
  const double weight_b = std::clamp(b / sum, 0.0, 1.0 - weight_a);
  return {weight_a, weight_b, 1.0 - (weight_a + weight_b)};
}

/// Barycentric weights of a point of the triangle when the ray gives none: it runs in the plane, or there is no plane.
Vec3 weights_of(const Vec3& point, const Triangle& t) {
  const Vec3 corner[3] = {t.a - point, t.b - point, t.c - point};
  const double scale = std::max({corner[0].cwiseAbs().maxCoeff(), corner[1].cwiseAbs().maxCoeff(),
                                 corner[2].cwiseAbs().maxCoeff(), std::numeric_limits<double>::min()});
  const Vec3 a = corner[0] / scale;
  const Vec3 b = corner[1] / scale;
  const Vec3 c = corner[2] / scale;
  const double area[3] = {b.cross(c).norm(), c.cross(a).norm(), a.cross(b).norm()};
  const double sum = area[0] + area[1] + area[2];
  if (sum > 1e-12) return normalized_weights(area[0], area[1], area[2]);
  // On an edge of a triangle without area: the corner pair around the point.
  const Vec3 span[3] = {a, b, c};
  Vec3 best(1, 0, 0);
  double best_length = -1;
  for (int i = 0; i < 3; ++i) {
    const Vec3& p = span[i];
    const Vec3& q = span[(i + 1) % 3];
    const double length = (q - p).norm();
    if (length <= best_length || p.dot(q) > 1e-12) continue;
    best_length = length;
    best = Vec3::Zero();
    const double part = length > 0 ? std::clamp(p.norm() / length, 0.0, 1.0) : 0.0;
    best[i] = 1 - part;
    best[(i + 1) % 3] = part;
  }
  return best;
}

template <class N>
void fill(const Ray& ray, const Triangle& triangle, const Facet<N>& facet, const Reach<N>& reach, RayHit& hit) {
  const Line<N> line(ray);
  const Scaled parameter = scaled(reach.numerator) / scaled(reach.denominator);
  const Bounded distance = plain(parameter * sqrt(scaled(square(line.direction))));
  hit.distance_m = distance.value;
  hit.distance_error_m = distance.bound();
  hit.exit_m = distance.value;
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
Decision cast_exactly(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  const Facet<N> facet(triangle);
  const Reach<N> reach = ray_to_facet(Line<N>(ray), facet);
  Decision decision = reach.meets;
  if (decision == Decision::yes) decision = within_length(reach, ray);
  if (decision == Decision::yes) fill(ray, triangle, facet, reach, hit);
  return decision;
}

/// The rungs above the filter; also asked when a hit is sure but its distance is not sharp.
[[gnu::noinline]] Verdict climb_from_filter(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  Decision decision = cast_exactly<Traced>(ray, triangle, hit);
  if (decision == Decision::no) return {decision, Level::filter};
  if (decision == Decision::yes && sharp({hit.distance_m, hit.distance_error_m}, kRefineRay)) {
    return {decision, Level::filter};
  }
  if (precision.highest == Level::filter) return {decision, Level::filter};
  decision = cast_exactly<Expansion>(ray, triangle, hit);
  if (decision != Decision::undecided || precision.highest == Level::expansion) return {decision, Level::expansion};
  return {cast_exactly<Dyadic>(ray, triangle, hit), Level::rational};
}

struct FilterState {
  Triple direction;
  Triple to_a;
  Triple ab;
  Triple ca;
  double direction2;
  double far2;   // largest squared distance from the origin to a corner
  double edge2;  // largest squared edge
  double side[3];
};

/// Overflow needs no check: it makes the bound infinite, and nothing is above that.
inline bool in_filter_range(double length2) { return length2 >= kFilterLowest2; }

/// The line surely meets the triangle's inside: find out where, and whether that is within the ray.
Verdict finish(const Ray& ray, const Triangle& triangle, const FilterState& s, RayHit& hit) {
  const Triple normal = cross(s.ca, s.ab);
  const double numerator = dot(s.to_a, normal);
  const double denominator = dot(s.direction, normal);
  const double ab2 = dot(s.ab, s.ab);
  const double ca2 = dot(s.ca, s.ca);
  const double to_a2 = dot(s.to_a, s.to_a);
  // The largest edge and corner distance are in range; the ones used here may still be tiny.
  if (!in_filter_range(std::min({ab2, ca2, to_a2}))) return climb_from_filter(ray, triangle, hit);
  const double area_scale = std::sqrt(ab2 * ca2);
  const double numerator_error = kTripleProductError * std::sqrt(to_a2) * area_scale;
  const double length = std::sqrt(s.direction2);
  const double denominator_error = kTripleProductError * length * area_scale;
  const double size = std::abs(denominator);
  if (!(std::abs(numerator) > numerator_error) || !(size > 2 * denominator_error)) {
    return climb_from_filter(ray, triangle, hit);
  }
  if ((numerator > 0) != (denominator > 0)) return {Decision::no, Level::filter};
  const double parameter = numerator / denominator;
  const double distance = parameter * length;
  // Of a quotient whose terms have the relative errors n and d: (n + d) / (1 - d); then quotient, norm and product.
  const double denominator_part = denominator_error / size;
  const double relative = (numerator_error / std::abs(numerator) + denominator_part) / (1 - denominator_part) *
                              (1 + kBoundSlack) + 8 * kRoundoff;
  const double error = distance * relative;
  if (distance - error > ray.length_m) return {Decision::no, Level::filter};
  if (!(distance + error <= ray.length_m) || !std::isfinite(distance)) return climb_from_filter(ray, triangle, hit);
  if (relative > kRefineRay && !sharp({distance, error}, kRefineRay)) {
    const Verdict exact = climb_from_filter(ray, triangle, hit);
    return {exact.decision, Level::filter};
  }
  hit.distance_m = distance;
  hit.distance_error_m = error;
  hit.exit_m = distance;
  hit.inside = false;
  hit.point = ray.origin + parameter * ray.direction;
  const double against = (denominator > 0 ? -1 : 1) / std::sqrt(dot(normal, normal));
  hit.normal = Vec3(normal.x * against, normal.y * against, normal.z * against);
  hit.weights = normalized_weights(s.side[1], s.side[2], s.side[0]);
  return {Decision::yes, Level::filter};
}

}  // namespace

Verdict cast_ray(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  const Triple o = triple(ray.origin);
  const Triple a = triple(triangle.a);
  const Triple b = triple(triangle.b);
  const Triple c = triple(triangle.c);
  FilterState s;
  s.direction = triple(ray.direction);
  s.to_a = a - o;
  const Triple to_b = b - o;
  const Triple to_c = c - o;
  s.ab = b - a;
  s.ca = a - c;
  const Triple bc = c - b;
  s.side[0] = dot(s.ab, cross(s.to_a, s.direction));
  s.side[1] = dot(bc, cross(to_b, s.direction));
  s.side[2] = dot(s.ca, cross(to_c, s.direction));
  s.direction2 = dot(s.direction, s.direction);
  s.far2 = std::max({dot(s.to_a, s.to_a), dot(to_b, to_b), dot(to_c, to_c)});
  s.edge2 = std::max({dot(s.ab, s.ab), dot(bc, bc), dot(s.ca, s.ca)});
  if (in_filter_range(s.direction2) && in_filter_range(s.far2) && in_filter_range(s.edge2)) {
    // Squares keep their sign, so no root is needed.
    const double bound = kTripleProductError * kTripleProductError * s.edge2 * s.far2 * s.direction2;
    const double signed_square[3] = {s.side[0] * std::abs(s.side[0]), s.side[1] * std::abs(s.side[1]),
                                     s.side[2] * std::abs(s.side[2])};
    const double largest = std::max({signed_square[0], signed_square[1], signed_square[2]});
    const double smallest = std::min({signed_square[0], signed_square[1], signed_square[2]});
    if (largest > bound && smallest < -bound) return {Decision::no, Level::filter};
    if (smallest > bound || largest < -bound) return finish(ray, triangle, s, hit);
  }
  return climb_from_filter(ray, triangle, hit);
}

namespace {

template <class N>
Decision first_is_nearer(const Ray& ray, const Triangle& a, const Triangle& b, int& order) {
  const Reach<N> reach_a = ray_to_facet(Line<N>(ray), Facet<N>(a));
  const Reach<N> reach_b = ray_to_facet(Line<N>(ray), Facet<N>(b));
  if (reach_a.meets == Decision::undecided || reach_b.meets == Decision::undecided) return Decision::undecided;
  const Sign s = sign(reach_a.numerator * reach_b.denominator - reach_b.numerator * reach_a.denominator);
  if (s == Sign::unsure) return Decision::undecided;
  order = static_cast<int>(s);
  return Decision::yes;
}

}  // namespace

int compare_hits(const Ray& ray, const Triangle& a, const Triangle& b) {
  int order = 0;
  climb([&]<class N>() { return first_is_nearer<N>(ray, a, b, order); });
  return order;
}

}  // namespace collided
