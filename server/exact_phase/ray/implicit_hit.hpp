#pragma once

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/ray/implicit_ray.hpp"

namespace collided::engine::kernel {

/// Distance and point from the bracket.
void set_place(const Ray& ray, double low, double high, ImplicitHit& hit);

/// The unit vector along an enclosed gradient, with its bound, if that is below 1: the normal is then known.
/// returns  the bound, infinite where there is none
double set_normal(const Vector<Bounded>& slope, ImplicitHit& hit);

/// What a bracket may be wide: as asked for, or what the thread's precision is content with.
bool narrow_enough(const Ray& ray, double low, double high, double relative_width);

}  // namespace collided::engine::kernel
