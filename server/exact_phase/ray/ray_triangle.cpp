#include <algorithm>

#include "server/exact_phase/arithmetic/triple.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/exact_phase/ray/ray_triangle_kernel.hpp"
#include "server/exact_phase/ray/ray_triangle_sides.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

using namespace kernel;

/// Computes in double where a ray meets the triangle's plane, for a ray known to meet the triangle. False: that is not
/// precise enough, or the ray may lie in the plane.
bool fill_sharply(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  const Facet<Traced> facet(triangle);
  const Line<Traced> line(ray);
  const Sign slope = sign(dot(line.direction, facet.normal));
  if (slope == Sign::zero || slope == Sign::unsure) return false;
  fill(ray, triangle, facet, ray_to_plane(line, facet, slope == Sign::negative), hit);
  return hit.distance_m >= 0 && sharp({hit.distance_m, hit.distance_error_m}, kRefineRay);
}

/// Expansions are needed for the signs, but seldom for the numbers.
Decision cast_over_expansions(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  const Facet<Expansion> facet(triangle);
  Reach<Expansion> reach;
  const Decision decision = meet_facet(ray, facet, reach);
  if (decision == Decision::yes && !fill_sharply(ray, triangle, hit)) fill(ray, triangle, facet, reach, hit);
  return decision;
}

/// The rungs above the filter; also used where a hit is certain but its distance is not precise enough.
[[gnu::noinline]] ExactResult climb_higher(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  Decision decision = cast_facet<Traced>(ray, triangle, hit);
  if (decision == Decision::no) return {decision, Level::filter};
  if (decision == Decision::yes && sharp({hit.distance_m, hit.distance_error_m}, kRefineRay)) {
    return {decision, Level::filter};
  }
  if (precision.highest == Level::filter) return {decision, Level::filter};
  if (decision == Decision::undecided) ++rungs.expansion;
  decision = cast_over_expansions(ray, triangle, hit);
  if (decision != Decision::undecided || precision.highest == Level::expansion) return {decision, Level::expansion};
  ++rungs.rational;
  return {cast_facet<Dyadic>(ray, triangle, hit), Level::rational};
}

[[gnu::noinline]] ExactResult climb_from_filter(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  ++rungs.uncertain;
  return climb_higher(ray, triangle, hit);
}

inline bool in_filter_range(double length2) { return length2 >= kFilterLowest2; }

/// The line surely meets the triangle's inside: computes where, and whether that is within the ray.
ExactResult finish(const Ray& ray, const Triangle& triangle, const RaySides& s, RayHit& hit) {
  const Triple a = triple(triangle.a);
  const Triple to_a = a - triple(ray.origin);
  const Triple normal = cross(a - triple(triangle.c), triple(triangle.b) - a);
  const double numerator = dot(to_a, normal);
  const double denominator = dot(triple(ray.direction), normal);
  const double ab2 = s.edge2[0];
  const double ca2 = s.edge2[2];
  const double to_a2 = s.corner2[0];
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
  // A quotient whose terms have relative errors n and d errs by (n + d) / (1 - d); then come quotient, norm and
  // product.
  const double denominator_part = denominator_error / size;
  const double relative =
      (numerator_error / std::abs(numerator) + denominator_part) / (1 - denominator_part) * (1 + kBoundSlack) +
      8 * kRoundoff;
  const double error = distance * relative;
  if (distance - error > ray.length_m) return {Decision::no, Level::filter};
  if (!(distance + error <= ray.length_m) || !std::isfinite(distance)) return climb_from_filter(ray, triangle, hit);
  if (relative > kRefineRay && !sharp({distance, error}, kRefineRay)) {
    ++rungs.sharpened;
    const ExactResult exact = climb_higher(ray, triangle, hit);
    return {exact.decision, Level::filter};
  }
  hit.distance_m = distance;
  hit.distance_error_m = error;
  hit.exit_m = distance;
  hit.exit_error_m = error;
  hit.inside = false;
  hit.point = ray.origin + parameter * ray.direction;
  const double against = (denominator > 0 ? -1 : 1) / std::sqrt(dot(normal, normal));
  hit.normal = Vec3(normal.x * against, normal.y * against, normal.z * against);
  hit.weights = normalized_weights(s.side[1], s.side[2], s.side[0]);
  return {Decision::yes, Level::filter};
}

}  // namespace

ExactResult cast_ray(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  RaySides sides;
  switch (ray_sides(ray, triangle, sides)) {
    case SidesVerdict::miss: return {Decision::no, Level::filter};
    case SidesVerdict::inside: return finish(ray, triangle, sides, hit);
    default: return climb_from_filter(ray, triangle, hit);
  }
}

namespace {

/// Sets the order of two hits; undecided where signs are unsure.
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

}  // namespace collided::engine
