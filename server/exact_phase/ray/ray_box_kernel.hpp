#pragma once

#include <array>

#include "server/exact_phase/kernels/box_kernel.hpp"
#include "server/exact_phase/ray/ray_hit_value.hpp"

namespace collided::engine::kernel {

/// One pair of faces: the ray is between them while near <= s * speed <= far, with speed >= 0. At speed 0 the two are
/// the distances to the faces, of which only the signs are used.
template <class N>
struct Slab {
  N near;
  N far;
  N speed;
  Sign direction;
};

template <class N>
std::array<Slab<N>, 3> slabs_along(const Ray& ray, const Solid<N>& box) {
  const Vector<N> w = Vector<N>(ray.origin) - box.center;
  const Vector<N> d(ray.direction);
  std::array<Slab<N>, 3> slabs;
  for (int i = 0; i < 3; ++i) {
    const N along = dot(w, box.normal[i]);
    const N speed = dot(d, box.normal[i]);
    const Sign s = sign(speed);
    if (s == Sign::negative) slabs[i] = {along - box.height[i], along + box.height[i], -speed, s};
    else slabs[i] = {-box.height[i] - along, box.height[i] - along, speed, s};
  }
  return slabs;
}

/// Whether the slabs, the half line s >= 0 and the ray's length share a parameter.
template <class N>
Decision slabs_meet(const std::array<Slab<N>, 3>& slabs, const Ray& ray) {
  AllOf all;
  for (const Slab<N>& slab : slabs) {
    if (slab.direction == Sign::unsure) return Decision::undecided;
    all.add(at_most(N(0.0), slab.far));
    if (slab.direction == Sign::zero) all.add(at_most(slab.near, N(0.0)));
    if (all.result() == Decision::no) return Decision::no;
  }
  const N dd = square(Vector<N>(ray.direction));
  for (int i = 0; i < 3; ++i) {
    const Slab<N>& in = slabs[i];
    if (in.direction == Sign::zero) continue;
    for (int j = 0; j < 3; ++j) {
      if (j == i || slabs[j].direction == Sign::zero) continue;
      if (all.add(at_most(in.near * slabs[j].speed, slabs[j].far * in.speed))) return Decision::no;
    }
    if (std::isinf(ray.length_m)) continue;
    const N limit = N(ray.length_m) * in.speed;
    if (all.add(either(at_most(in.near, N(0.0)), at_most(in.near * in.near * dd, limit * limit)))) return Decision::no;
  }
  return all.result();
}

template <class N>
Decision starts_between(const std::array<Slab<N>, 3>& slabs) {
  AllOf all;
  for (const Slab<N>& slab : slabs) all.add(at_most(slab.near, N(0.0)));
  return all.result();
}

/// Where a ray enters and leaves a box, and through which faces.
struct BoxCrossing {
  Bounded entry_m;
  Bounded exit_m;
  int entry_face = 0;
  int exit_face = 0;
  bool inside = false;
};

/// The latest entry and the earliest exit; if two compete, the bound covers both.
template <class N>
void cross_slabs(const Ray& ray, const Solid<N>& box, const std::array<Slab<N>, 3>& slabs, BoxCrossing& crossing) {
  const Scaled length = length_of<N>(ray);
  bool first = true;
  for (int i = 0; i < 3; ++i) {
    if (slabs[i].direction == Sign::zero || !box.spans()) continue;
    const Scaled speed = scaled(slabs[i].speed);
    const Bounded in = plain(scaled(slabs[i].near) / speed * length);
    const Bounded out = plain(scaled(slabs[i].far) / speed * length);
    if (first || in.value > crossing.entry_m.value) crossing.entry_face = i;
    if (first || out.value < crossing.exit_m.value) crossing.exit_face = i;
    crossing.entry_m = first ? in : greater(crossing.entry_m, in);
    crossing.exit_m = first ? out : lesser(crossing.exit_m, out);
    first = false;
  }
}

template <class N>
Decision cast_box(const Ray& ray, const Box& shape, BoxCrossing& crossing) {
  const Solid<N> box(shape);
  if (!box.spans()) return Decision::undecided;
  const std::array<Slab<N>, 3> slabs = slabs_along(ray, box);
  const Decision meets = slabs_meet(slabs, ray);
  if (meets != Decision::yes) return meets;
  const Decision inside = starts_between(slabs);
  crossing.inside = inside == Decision::yes;
  cross_slabs(ray, box, slabs, crossing);
  return inside == Decision::undecided ? inside : meets;
}

template <class Climb>
ExactResult cast_solid(const Ray& ray, const Box& box, RayHit& hit) {
  BoxCrossing crossing;
  const ExactResult verdict = Climb::climb([&]<class N>() { return cast_box<N>(ray, box, crossing); });
  if (!verdict.yes()) return verdict;
  const Bounded& needed = crossing.inside ? crossing.exit_m : crossing.entry_m;
  if (!sharp(needed, kRefineRay)) cast_box<Dyadic>(ray, box, crossing);
  set_interval(ray, crossing.inside, crossing.entry_m, crossing.exit_m, hit);
  const int face = crossing.inside ? crossing.exit_face : crossing.entry_face;
  const Solid<Bounded> solid(box);
  const Vec3 normal = unit(solid.normal[face]);
  const bool flip = (normal.dot(unit(ray.direction)) > 0) != crossing.inside;
  set_normal(ray, flip ? Vec3(-normal) : normal, hit);
  return verdict;
}

}  // namespace collided::engine::kernel
