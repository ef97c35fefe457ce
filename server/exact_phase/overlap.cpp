#include "server/exact_phase/overlap.hpp"

#include <variant>

#include "server/exact_phase/nearest_kernel.hpp"

namespace collided {
namespace {

using namespace kernel;

template <class N>
N radius2(double a, double b) {
  const N sum = N(a) + N(b);
  return sum * sum;
}

template <class N>
N radius2(double radius_m) {
  return N(radius_m) * N(radius_m);
}

template <class N>
Segment<N> core(const Capsule& capsule) {
  return {Vector<N>(capsule.a), Vector<N>(capsule.b)};
}

}  // namespace

Verdict overlaps(const Sphere& a, const Sphere& b) {
  return climb([&]<class N>() {
    return at_most(square(Vector<N>(a.center) - Vector<N>(b.center)), radius2<N>(a.radius_m, b.radius_m));
  });
}

Verdict overlaps(const Sphere& a, const Box& b) {
  const Pattern guess = guessed_pattern(a.center, b);
  return climb([&]<class N>() {
    const Solid<N> box(b);
    const Vector<N> w = Vector<N>(a.center) - box.center;
    // The guessed feature, once it proves to be the nearest, decides alone.
    if (guess != Pattern{} && box.spans()) {
      const Nearest<N> nearest = nearest_at(w, box, guess);
      if (nearest.sure == Decision::yes) return at_most(nearest.square, radius2<N>(a.radius_m) * nearest.scale);
    }
    return point_near_solid(w, box, radius2<N>(a.radius_m));
  });
}

Verdict overlaps(const Sphere& a, const Capsule& b) {
  return climb([&]<class N>() {
    return point_near_segment(Vector<N>(a.center), core<N>(b), radius2<N>(a.radius_m, b.radius_m));
  });
}

Verdict overlaps(const Sphere& a, const Triangle& b) {
  return climb([&]<class N>() {
    return point_near_facet(Vector<N>(a.center), Facet<N>(b), radius2<N>(a.radius_m));
  });
}

Verdict overlaps(const Box& a, const Box& b) {
  return climb([&]<class N>() {
    const Solid<N> solid_a(a);
    const Solid<N> solid_b(b);
    return bodies_meet(Body<N>(solid_a), Body<N>(solid_b));
  });
}

Verdict overlaps(const Box& a, const Capsule& b) {
  return climb([&]<class N>() {
    return segment_near_solid(core<N>(b), Solid<N>(a), radius2<N>(b.radius_m));
  });
}

Verdict overlaps(const Box& a, const Triangle& b) {
  return climb([&]<class N>() {
    const Solid<N> solid(a);
    return bodies_meet(Body<N>(solid), Body<N>(Facet<N>(b)));
  });
}

Verdict overlaps(const Capsule& a, const Capsule& b) {
  return climb([&]<class N>() {
    return segments_near(core<N>(a), core<N>(b), radius2<N>(a.radius_m, b.radius_m));
  });
}

Verdict overlaps(const Capsule& a, const Triangle& b) {
  return climb([&]<class N>() {
    return segment_near_facet(core<N>(a), Facet<N>(b), radius2<N>(a.radius_m));
  });
}

Verdict overlaps(const Triangle& a, const Triangle& b) {
  return climb([&]<class N>() { return facets_meet(Facet<N>(a), Facet<N>(b)); });
}

Verdict overlaps(const Primitive& a, const Primitive& b) {
  return std::visit([](const auto& first, const auto& second) { return overlaps(first, second); }, a, b);
}

Verdict overlaps(const Primitive& a, const Triangle& b) {
  return std::visit([&](const auto& solid) { return overlaps(solid, b); }, a);
}

}  // namespace collided
