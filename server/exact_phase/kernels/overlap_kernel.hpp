#pragma once

#include "server/exact_phase/kernels/nearest_kernel.hpp"
#include "server/geometry/shapes.hpp"

namespace collided::engine::kernel {

// Whether two closed sets share a point: one function per pair of kinds, over any number type.

template <class N>
N radius2(double a, double b) {
  const N sum = N(a) + N(b);
  return sum * sum;
}

template <class N>
N radius2(double radius_m) {
  return N(radius_m) * N(radius_m);
}

/// The segment of a capsule.
template <class N>
Segment<N> core(const Capsule& capsule) {
  return {Vector<N>(capsule.a), Vector<N>(capsule.b)};
}

template <class N>
Decision sets_meet(const Sphere& a, const Sphere& b) {
  return at_most(square(Vector<N>(a.center) - Vector<N>(b.center)), radius2<N>(a.radius_m, b.radius_m));
}

template <class N>
Decision sets_meet(const Sphere& a, const Box& b) {
  const Pattern guess = guessed_pattern(a.center, b);
  const Solid<N> box(b);
  const Vector<N> w = Vector<N>(a.center) - box.center;
  // The guessed feature alone decides if it proves to be the nearest.
  if (guess != Pattern{} && box.spans()) {
    const Nearest<N> nearest = nearest_at(w, box, guess);
    if (nearest.sure == Decision::yes) return at_most(nearest.square, radius2<N>(a.radius_m) * nearest.scale);
  }
  return point_near_solid(w, box, radius2<N>(a.radius_m));
}

template <class N>
Decision sets_meet(const Sphere& a, const Capsule& b) {
  return point_near_segment(Vector<N>(a.center), core<N>(b), radius2<N>(a.radius_m, b.radius_m));
}

template <class N>
Decision sets_meet(const Sphere& a, const Triangle& b) {
  return point_near_facet(Vector<N>(a.center), Facet<N>(b), radius2<N>(a.radius_m));
}

template <class N>
Decision sets_meet(const Box& a, const Box& b) {
  const Solid<N> solid_a(a);
  const Solid<N> solid_b(b);
  return bodies_meet(Body<N>(solid_a), Body<N>(solid_b));
}

template <class N>
Decision sets_meet(const Box& a, const Capsule& b) {
  return segment_near_solid(core<N>(b), Solid<N>(a), radius2<N>(b.radius_m));
}

template <class N>
Decision sets_meet(const Box& a, const Triangle& b) {
  const Solid<N> solid(a);
  return bodies_meet(Body<N>(solid), Body<N>(Facet<N>(b)));
}

template <class N>
Decision sets_meet(const Capsule& a, const Capsule& b) {
  return segments_near(core<N>(a), core<N>(b), radius2<N>(a.radius_m, b.radius_m));
}

template <class N>
Decision sets_meet(const Capsule& a, const Triangle& b) {
  return segment_near_facet(core<N>(a), Facet<N>(b), radius2<N>(a.radius_m));
}

template <class N>
Decision sets_meet(const Triangle& a, const Triangle& b) {
  return facets_meet(Facet<N>(a), Facet<N>(b));
}

}  // namespace collided::engine::kernel
