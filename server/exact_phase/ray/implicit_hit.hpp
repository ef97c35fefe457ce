#pragma once

#include "server/exact_phase/arithmetic/value.hpp"
#include "server/exact_phase/ray/implicit_ray.hpp"

namespace collided::engine::kernel {

/// Sets distance and point from the bracket of the parameter.
void set_place(const Ray& ray, double low, double high, ImplicitHit& hit);

/// Sets the normal to the unit vector along a gradient with bounds, if the vector's error is below 1.
/// returns  the bound on that error, infinite if it is not below 1
double set_normal(const Vector<Bounded>& slope, ImplicitHit& hit);

/// True if a bracket is narrow enough: as requested, or as the thread's precision allows.
bool narrow_enough(const Ray& ray, double low, double high, double relative_width);

}  // namespace collided::engine::kernel
