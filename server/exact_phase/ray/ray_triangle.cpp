#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/exact_phase/ray/ray_triangle_filter.hpp"
#include "server/exact_phase/ray/ray_triangle_kernel.hpp"
#include "server/geometry/tolerance.hpp"

namespace collided::engine {
namespace {

using namespace kernel;

/// Computes in double where a ray meets the triangle's plane, for a ray known to meet the triangle. False if that is
/// not precise enough, or the ray may lie in the plane.
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

/// The rungs above the filter; also used if a hit is certain but its distance is not precise enough.
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

[[gnu::noinline]] ExactResult sharpen(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  ++rungs.sharpened;
  const ExactResult exact = climb_higher(ray, triangle, hit);
  return {exact.decision, Level::filter};
}

}  // namespace

ExactResult cast_ray(const Ray& ray, const Triangle& triangle, RayHit& hit) {
  switch (filter_ray(ray, triangle, hit)) {
    case FilterVerdict::miss: return {Decision::no, Level::filter};
    case FilterVerdict::hit: return {Decision::yes, Level::filter};
    case FilterVerdict::blunt: return sharpen(ray, triangle, hit);
    default: return climb_from_filter(ray, triangle, hit);
  }
}

namespace {

bool lies_at(const Triangle& t, int axis, double coordinate) {
  return t.a[axis] == coordinate && t.b[axis] == coordinate && t.c[axis] == coordinate;
}

/// True if both triangles lie in one plane perpendicular to an axis, which the ray crosses: then it meets both in one
/// point. Walls, floors and objects standing on them tie in this way, and expansions would take as long as a hundred
/// rays to show it.
bool meets_one_plane_of_both(const Ray& ray, const Triangle& a, const Triangle& b) {
  for (int axis = 0; axis < 3; ++axis) {
    const double coordinate = a.a[axis];
    if (ray.direction[axis] != 0 && lies_at(a, axis, coordinate) && lies_at(b, axis, coordinate)) return true;
  }
  return false;
}

/// Sets the order of two hits; undecided if signs are unsure.
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
  if (meets_one_plane_of_both(ray, a, b)) return 0;
  int order = 0;
  climb([&]<class N>() { return first_is_nearer<N>(ray, a, b, order); });
  return order;
}

}  // namespace collided::engine
